/* Internal: what a field of rocks keeps. */
#ifndef PL_TERRAIN_ROCK_PARTS_H
#define PL_TERRAIN_ROCK_PARTS_H

#include "terrain/rock_field.h"

struct pl_rock_field {
  pl_rock_frame frame;
  double *table; /* the law's table, owned */
  pl_scatter scatter;
  pl_scatter blocks;                 /* candidates for those about craters; empty without */
  pl_rock_sphere *spheres;           /* owned */
  pl_rock_variant *variants;         /* owned */
  double families[PL_ROCK_FAMILIES]; /* cumulative weights, the last 1 */
};

/* Candidates of a cell: those of the law, then blocks, whose ids have a bit of their own. */
enum { PL_ROCK_BLOCK_BIT = 512 };
uint64_t pl_rock_candidates(const pl_rock_region *region, const pl_scatter_cell *cell,
                            uint64_t *laws);
/* Draws a candidate below pl_rock_candidates; false if there is none. */
bool pl_rock_draw(const pl_rock_region *region, const pl_scatter_cell *cell, uint64_t n,
                  uint64_t laws, pl_scatter_site *out);

#endif
