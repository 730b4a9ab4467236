/* Vignetting: the product of a power of the cosine, a table by angle and a measured flat field. */
#ifndef PL_SENSOR_SHADING_H
#define PL_SENSOR_SHADING_H

#include "base/status.h"

enum { PL_SHADING_POINTS = 64 };

typedef struct pl_shading {
  double power; /* exponent of the cosine of the angle to the axis; 4: a thin lens, 0: none */
  /* Factors at angles to the axis, linearly interpolated and constant beyond the ends; count 0:
   * none. */
  int count;
  double angle_rad[PL_SHADING_POINTS]; /* increasing */
  double factor[PL_SHADING_POINTS];    /* 0..1 */
  /* Factors over the image, row-major, interpolated bilinearly over the whole image; NULL: none. */
  const float *flat; /* borrowed */
  int flat_width, flat_height;
  double flat_low, flat_high; /* range of the factors */
} pl_shading;

/* Sets the flat field and its range. Fails with PL_E_RANGE if a factor is not in 0..100. */
pl_status pl_shading_set_flat(pl_shading *shading, const float *flat, int width, int height);
/* Fails with PL_E_RANGE and names the value that is out of range, or if the angles do not increase.
 */
pl_status pl_shading_check(const pl_shading *shading);

/* The factor in a direction (tangents of the angles to the axis) and at a position in the image
 * (0..1). */
double pl_shading_at(const pl_shading *shading, const double tangent[2], const double place[2]);
/* Bounds of the factor within an angle (given by its tangent) of the axis. */
void pl_shading_range(const pl_shading *shading, double tangent, double *low, double *high);

#endif
