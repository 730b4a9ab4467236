/* The random numbers of one wave of paths: all dimensions of a vertex, for all paths at once. */
#ifndef PL_RENDER_DRAWS_H
#define PL_RENDER_DRAWS_H

#include <stddef.h>
#include <stdint.h>

/* What a vertex draws; arrays as long as a wave. */
typedef struct pl_draws {
  float *sun[2];       /* a point of the sun's disc */
  float *direction[2]; /* where the path goes on; NULL: drawn otherwise */
  float *choice[2];    /* of the lobe; of the path's survival */
} pl_draws;

/* Fills all arrays for `count` paths: sample `index` of the pixels with these seeds, at the vertex
 * after `bounce` bounces. Integer arithmetic throughout, so that the wide and the plain version of
 * the loop give the same bits. */
void pl_draws_fill(const pl_draws *draws, const uint32_t *seeds, size_t count, uint32_t index,
                   uint32_t bounce);

/* Fills the two arrays of directions: sample `index` of these pixels of a tile, which lies as
 * evenly over every aligned square of 2^k pixels to a side as it does over a pixel's samples, so
 * that pixels which pool what they find have noise of less than as many draws of chance. Rows of
 * the tile are of 2^row_bits pixels. */
void pl_draws_spread(float *const direction[2], const uint32_t *pixels, size_t count,
                     uint32_t row_bits, uint32_t tile_seed, uint32_t index);

#endif
