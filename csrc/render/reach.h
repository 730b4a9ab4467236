/* Which pixels a mesh can show in: the projections of boxes about it and, where it pays, of its
 * triangles. */
#ifndef PL_RENDER_REACH_H
#define PL_RENDER_REACH_H

#include <stdatomic.h>
#include <stdbool.h>

#include "scene/snapshot.h"

typedef struct pl_reach {
  int width, height;
  atomic_uchar *pixels; /* owned; 1 where a ray through the pixel may meet a mesh */
  size_t room;          /* bytes allocated */
} pl_reach;

/* Fills the pixels of rows row0 to row1 - 1 for a snapshot; those of others are not valid. Memory
 * is kept and grows as needed. `rays`: how many a pixel gets about, which is what it pays to look
 * closely for; at least 1. The result is the same for any number of threads. */
pl_status pl_reach_update(pl_reach *reach, const pl_snapshot *shot, int row0, int row1, int rays,
                          int threads);
void pl_reach_clear(pl_reach *reach);

static inline bool pl_reach_pixel(const pl_reach *reach, int x, int y) {
  return atomic_load_explicit(&reach->pixels[(size_t)y * (size_t)reach->width + (size_t)x],
                              memory_order_relaxed) != 0;
}

#endif
