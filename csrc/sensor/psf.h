/* The point-spread function of a lens: a core and wings, over pixels. */
#ifndef PL_SENSOR_PSF_H
#define PL_SENSOR_PSF_H

#include "sensor/sensor.h"

/* Energy that lands farther than `radius_px` from its place, 0..1, in a band. */
double pl_psf_outside(const pl_sensor *sensor, int band, double radius_px);
/* Fills (2 reach_x + 1) x (2 reach_y + 1) parts of the energy that pixels around the middle get, of
 * light at the middle of a pixel. Their sum is 1: what falls outside is spread evenly over all
 * (`spread`), or stays in the middle. With `spread` the sum is less where a measured kernel says
 * what lands farther out. */
void pl_psf_kernel(const pl_sensor *sensor, int band, int reach_x, int reach_y, bool spread,
                   double *kernel);

#endif
