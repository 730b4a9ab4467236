/* Stars as points of light at infinity, sorted by place and brightness. */
#ifndef PL_SKY_CATALOGUE_H
#define PL_SKY_CATALOGUE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "math/vec.h"

typedef struct pl_star {
  pl_vec3 direction; /* unit, root axes (ICRF), for an observer at rest */
  float light[3];    /* irradiance on a plate facing it, W m-2 in each band */
  float magnitude;   /* the catalogue's; carried along for labels */
  int64_t number;    /* likewise */
} pl_star;

/* Brightness that stars are ordered by: that of their brightest band. */
static inline float pl_star_brightness(const pl_star *star) {
  return pl_maxf(star->light[0], pl_maxf(star->light[1], star->light[2]));
}

/* A part of the sky. */
typedef struct pl_sky_cell {
  size_t first, count;   /* its stars, the brightest first */
  pl_vec3 axis;          /* unit */
  double half_angle_rad; /* about the axis, of a cone that holds them all */
} pl_sky_cell;

/* Sides of a cube's faces in cells. */
enum { PL_SKY_GRID = 12, PL_SKY_CELLS = 6 * PL_SKY_GRID * PL_SKY_GRID };

typedef struct pl_star_catalogue {
  pl_star *stars; /* owned, cell by cell */
  double *rest;   /* owned, of each star: brightness of those after it in its cell, summed */
  size_t count;
  pl_sky_cell cells[PL_SKY_CELLS];
} pl_star_catalogue;

/* Copies and sorts the stars; directions need not be unit. Of stars that are equally bright the
 * earlier comes first. PL_E_RANGE naming the star's place in the list for a direction that is zero
 * or not finite, or light that is negative or not finite. */
pl_status pl_star_catalogue_create(const pl_star *stars, size_t count, pl_star_catalogue **out);
void pl_star_catalogue_destroy(pl_star_catalogue *catalogue);

#endif
