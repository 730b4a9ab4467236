/* The random numbers of one wave of paths: all dimensions of a vertex, for all paths at once. */
#ifndef PL_RENDER_DRAWS_H
#define PL_RENDER_DRAWS_H

#include <stddef.h>
#include <stdint.h>

/* What a vertex draws; arrays as long as a wave. */
typedef struct pl_draws {
  float *sun[2];       /* a point of the sun's disc */
  float *direction[2]; /* where the path goes on */
  float *choice[2];    /* of the lobe; of the path's survival */
} pl_draws;

/* Fills all arrays for `count` paths: sample `index` of the pixels with these seeds, at the vertex
 * after `bounce` bounces. Integer arithmetic throughout, so that the wide and the plain version of
 * the loop give the same bits. */
void pl_draws_fill(const pl_draws *draws, const uint32_t *seeds, size_t count, uint32_t index,
                   uint32_t bounce);

#endif
