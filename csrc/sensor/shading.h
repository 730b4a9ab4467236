/* What a lens's light falls off by over the image: a power of the cosine, a table by angle, and a
 * measured flat field; all multiply. */
#ifndef PL_SENSOR_SHADING_H
#define PL_SENSOR_SHADING_H

#include "base/status.h"

enum { PL_SHADING_POINTS = 64 };

typedef struct pl_shading {
  double power; /* of the cosine of the angle to the axis; 4: a thin lens, 0: none */
  /* Factors at angles to the axis, linear between, the first and last hold beyond; 0 points: none.
   */
  int count;
  double angle_rad[PL_SHADING_POINTS]; /* rising */
  double factor[PL_SHADING_POINTS];    /* 0..1 */
  /* Factors over the image, row-major, stretched over it by bilinear interpolation; NULL: none. */
  const float *flat; /* borrowed */
  int flat_width, flat_height;
  double flat_low, flat_high; /* their range */
} pl_shading;

/* Sets the flat field with its range. PL_E_RANGE for factors that are not in 0..100. */
pl_status pl_shading_set_flat(pl_shading *shading, const float *flat, int width, int height);
/* PL_E_RANGE naming what is outside of its range, or angles that do not rise. */
pl_status pl_shading_check(const pl_shading *shading);

/* The factor at a direction (tangents to the axis) and a place in the image (0..1 over it). */
double pl_shading_at(const pl_shading *shading, const double tangent[2], const double place[2]);
/* Bounds of it within an angle (its tangent) of the axis. */
void pl_shading_range(const pl_shading *shading, double tangent, double *low, double *high);

#endif
