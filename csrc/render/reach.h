/* Which blocks of pixels a mesh can show in: the projections of the meshes' boxes. */
#ifndef PL_RENDER_REACH_H
#define PL_RENDER_REACH_H

#include <stdbool.h>
#include <stdint.h>

#include "scene/snapshot.h"

enum { PL_REACH_BLOCK = 4 }; /* pixels a side */

typedef struct pl_reach {
  int columns, rows; /* blocks */
  uint8_t *blocks;   /* owned; 1 where a ray through the block's pixels may meet a mesh */
  size_t room;       /* bytes allocated */
} pl_reach;

/* Fills the blocks for a snapshot; memory is kept and grows as needed. */
pl_status pl_reach_update(pl_reach *reach, const pl_snapshot *shot);
void pl_reach_clear(pl_reach *reach);
bool pl_reach_pixel(const pl_reach *reach, int x, int y);

#endif
