/* Internal representation of rings, private to this folder. */
#ifndef PL_RINGS_TABLE_H
#define PL_RINGS_TABLE_H

#include "rings/rings.h"

/* Means are tabulated for path lengths through the rings of 2^(k/2) times that along the normal. */
enum { PL_RINGS_NODES = 44, PL_RINGS_FIRST = -1, PL_RINGS_VALUES = 4 };
#define PL_RINGS_PATH_MAX 0x1p20 /* longer paths are clamped to this */

struct pl_rings {
  size_t count;
  double *edges_m; /* owned, as are the other arrays */
  double *depth, *albedo;
  /* [edge][node][value]: integrals over the radius from the inner edge */
  double *sums;
  double exponent, dust_share, dust_g;
  double norm; /* normalization of the particles' phase function, 1/sr */
  pl_rings_light_bounds bounds;
};

#endif
