/* Star catalogue: point sources at infinity, sorted by cell of the sky and brightness. */
#ifndef PL_SKY_CATALOGUE_H
#define PL_SKY_CATALOGUE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "math/vec.h"

typedef struct pl_star {
  pl_vec3 direction; /* unit, root axes (ICRF), for an observer at rest */
  float light[3];    /* irradiance on a surface perpendicular to the light, W m-2 in each band */
  float magnitude;   /* catalogue magnitude; only for labels */
  int64_t number;    /* catalogue number; only for labels */
} pl_star;

/* Brightness by which stars are sorted: irradiance in the brightest band. */
static inline float pl_star_brightness(const pl_star *star) {
  return pl_maxf(star->light[0], pl_maxf(star->light[1], star->light[2]));
}

/* A cell of the sky. */
typedef struct pl_sky_cell {
  size_t first, count; /* its stars, sorted from bright to faint */
  pl_vec3 axis;        /* unit */
  /* Half angle of a cone about the axis that contains all stars of the cell. */
  double half_angle_rad;
} pl_sky_cell;

/* Cells along the side of a cube face. */
enum { PL_SKY_GRID = 12, PL_SKY_CELLS = 6 * PL_SKY_GRID * PL_SKY_GRID };

typedef struct pl_star_catalogue {
  pl_star *stars; /* owned, sorted by cell */
  double *rest;   /* owned; for each star: summed brightness of the stars after it in its cell */
  size_t count;
  pl_sky_cell cells[PL_SKY_CELLS];
} pl_star_catalogue;

/* Copies and sorts the stars; directions need not be unit. Stars of equal brightness keep their
 * order. PL_E_RANGE with the star's index in the list for a direction that is zero or not finite,
 * or irradiance that is negative or not finite. */
pl_status pl_star_catalogue_create(const pl_star *stars, size_t count, pl_star_catalogue **out);
void pl_star_catalogue_destroy(pl_star_catalogue *catalogue);

#endif
