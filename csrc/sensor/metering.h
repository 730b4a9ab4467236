/* Automatic exposure of the sensor. */
#ifndef PL_SENSOR_METERING_H
#define PL_SENSOR_METERING_H

#include "sensor/sensor.h"

/* Returns the radiance that is to be white, from the pixels of a small raw image (row-major).
 * `scratch` has room for as many pixels. `fallback`: radiance of a sunlit white surface, returned
 * if nothing is lit. */
double pl_sensor_meter(const pl_auto_time *how, const float *signals, int width, int height,
                       float *scratch, double fallback);
/* Sets the exposure time that brings `radiance` (W m-2 sr-1) to white, within the limits of the
 * automatic exposure. If there are several gains, also sets the gain: the first for which the
 * longest time suffices. */
void pl_sensor_expose(pl_sensor *sensor, double radiance);

#endif
