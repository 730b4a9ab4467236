/* The point-spread function of a lens (core and wings), integrated over pixels. */
#ifndef PL_SENSOR_PSF_H
#define PL_SENSOR_PSF_H

#include "sensor/sensor.h"

/* Fraction of the energy, 0..1, that falls farther than `radius_px` from the source's image, in a
 * band. */
double pl_psf_outside(const pl_sensor *sensor, int band, double radius_px);
/* Fills a kernel of (2 reach_x + 1) x (2 reach_y + 1) pixels: the fractions of the energy that
 * surrounding pixels receive from a source at the centre of the central pixel. Their sum is 1:
 * energy outside the kernel is distributed uniformly over it (`spread`), or added to the central
 * pixel. With `spread` and a measured kernel the sum is less, because the energy outside is known
 * to fall there. */
void pl_psf_kernel(const pl_sensor *sensor, int band, int reach_x, int reach_y, bool spread,
                   double *kernel);

#endif
