/* Random numbers of one wave of paths: all dimensions of a vertex, for all paths at once. */
#ifndef PL_RENDER_DRAWS_H
#define PL_RENDER_DRAWS_H

#include <stddef.h>
#include <stdint.h>

/* Random numbers of a vertex; arrays as long as a wave. */
typedef struct pl_draws {
  float *sun[2];       /* point on the sun's disc */
  float *direction[2]; /* next direction of the path; NULL: sampled otherwise */
  float *choice[2];    /* body or mirror that is drawn; Russian roulette */
} pl_draws;

/* Fills all arrays for `count` paths: sample `index` of the pixels with these seeds, at the vertex
 * after `bounce` bounces. All arithmetic is on integers, so that the vectorised and the scalar
 * version of the loop give the same bits. */
void pl_draws_fill(const pl_draws *draws, const uint32_t *seeds, size_t count, uint32_t index,
                   uint32_t bounce);

/* Fills the two arrays of directions with sample `index` of these pixels of a tile. The samples are
 * stratified over every aligned square of 2^k pixels a side as well as over the samples of a pixel.
 * Pixels whose results are averaged by the irradiance filter therefore have less noise than as many
 * independent samples. Rows of the tile have 2^row_bits pixels. */
void pl_draws_spread(float *const direction[2], const uint32_t *pixels, size_t count,
                     uint32_t row_bits, uint32_t tile_seed, uint32_t index);

#endif
