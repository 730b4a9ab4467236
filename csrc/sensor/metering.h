/* Automatic exposure of the sensor. */
#ifndef PL_SENSOR_METERING_H
#define PL_SENSOR_METERING_H

#include "sensor/sensor.h"

/* The radiance that is to be white, by what the pixels of a small raw image say (row-major).
 * `scratch` has room for as many. `fallback`: that of a sunlit white surface, where nothing is lit.
 */
double pl_sensor_meter(const pl_auto_time *how, const float *signals, int width, int height,
                       float *scratch, double fallback);
/* Sets the exposure time, and with steps of gain the gain, that bring `radiance` (W m-2 sr-1,
 * white) to white, in the limits of the automatic: the first gain for which the longest time
 * suffices. */
void pl_sensor_expose(pl_sensor *sensor, double radiance);

#endif
