/* Which pixels a mesh can show in: the projections of boxes about it and, where it pays, of its
 * triangles. */
#ifndef PL_RENDER_COVERAGE_MASK_H
#define PL_RENDER_COVERAGE_MASK_H

#include <stdatomic.h>
#include <stdbool.h>

#include "scene/snapshot.h"

typedef struct pl_coverage {
  int width, height;
  atomic_uchar *pixels; /* owned; 1 where a ray through the pixel may meet a mesh */
  size_t room;          /* bytes allocated */
} pl_coverage;

/* Fills the pixels of rows row0 to row1 - 1 for a snapshot; those of others are not valid. Memory
 * is kept and grows as needed. `rays`: how many a pixel gets about, which is what it pays to look
 * closely for; at least 1. The result is the same for any number of threads. */
pl_status pl_coverage_update(pl_coverage *coverage, const pl_snapshot *shot, int row0, int row1,
                             int rays, int threads);
void pl_coverage_clear(pl_coverage *coverage);

static inline bool pl_coverage_pixel(const pl_coverage *coverage, int x, int y) {
  return atomic_load_explicit(&coverage->pixels[(size_t)y * (size_t)coverage->width + (size_t)x],
                              memory_order_relaxed) != 0;
}

#endif
