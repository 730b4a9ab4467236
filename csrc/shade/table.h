/* Lookup in tables with evenly spaced nodes. */
#ifndef PL_SHADE_TABLE_H
#define PL_SHADE_TABLE_H

#include <stddef.h>

#include "math/vec.h"

/* Index of the node below x of `count` nodes over 0..1 (x is clamped); *way: interpolation weight
 * of the next node, 0..1. */
static inline size_t pl_table_node(float x, int count, float *way) {
  const float at = pl_minf(pl_maxf(x, 0.0f), 1.0f) * (float)(count - 1);
  const size_t node = at < (float)(count - 2) ? (size_t)at : (size_t)(count - 2);
  *way = at - (float)node;
  return node;
}

static inline float pl_table_mix(float low, float high, float way) {
  return (1.0f - way) * low + way * high;
}

#endif
