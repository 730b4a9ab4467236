/* Internal: what a field of rocks keeps. */
#ifndef PL_TERRAIN_ROCK_PARTS_H
#define PL_TERRAIN_ROCK_PARTS_H

#include "terrain/rock_field.h"

struct pl_rock_field {
  pl_rock_frame frame;
  double *table; /* the law's table, owned */
  pl_scatter scatter;
  pl_rock_sphere *spheres;           /* owned */
  double families[PL_ROCK_FAMILIES]; /* cumulative shares, the last 1 */
};

#endif
