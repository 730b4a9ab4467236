/* Nodes of refined rasters, in blocks that each thread keeps. */
#ifndef PL_TERRAIN_DIAMOND_BLOCKS_H
#define PL_TERRAIN_DIAMOND_BLOCKS_H

#include "terrain/diamond_square.h"

/* A block has SIDE x SIDE cells, and APRON nodes around them: what the stencils of the next level
 * reach, so that a block needs no other than its parent. */
enum {
  PL_DIAMOND_SIDE = 16,
  PL_DIAMOND_APRON = 6,
  PL_DIAMOND_NODES = PL_DIAMOND_SIDE + 1 + 2 * PL_DIAMOND_APRON
};

/* The cells from node (SIDE i, SIDE j) of a level on; nodes row by row, the apron included. Level 0
 * has the high frequencies at the posts. */
typedef struct pl_diamond_block {
  uint64_t number; /* of the refinement; 0: none */
  int level;
  int64_t i, j;
  double h_m[PL_DIAMOND_NODES * PL_DIAMOND_NODES];
} pl_diamond_block;

/* Makes what this thread keeps, if it is not there; PL_E_MEMORY. */
pl_status pl_diamond_blocks_ready(void);
/* Returns a block, which stays until the next call; pl_diamond_blocks_ready must have been called
 * on this thread. */
const pl_diamond_block *pl_diamond_block_at(const pl_diamond_square *of,
                                            const pl_diamond_weights *weights, int level, int64_t i,
                                            int64_t j);

#endif
