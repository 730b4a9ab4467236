/* What rings are made of, within this folder. */
#ifndef PL_RINGS_TABLE_H
#define PL_RINGS_TABLE_H

#include "rings/rings.h"

/* Means are kept for paths through the rings of 2^(k/2) of the normal's length. */
enum { PL_RINGS_NODES = 44, PL_RINGS_FIRST = -1, PL_RINGS_VALUES = 4 };
#define PL_RINGS_PATH_MAX 0x1p20 /* longer paths count as so long */

struct pl_rings {
  size_t count;
  double *edges_m; /* owned, as are the others */
  double *depth, *albedo;
  /* [edge][node][value]: integrals over the radius from the inner edge on. */
  double *sums;
  double exponent, dust_share, dust_g;
  double norm; /* of the particles' phase function, 1/sr */
  pl_rings_reach reach;
};

#endif
