/* What a raster keeps: its levels and how its edges are connected. */
#ifndef PL_TERRAIN_RASTER_LEVELS_H
#define PL_TERRAIN_RASTER_LEVELS_H

#include <stdint.h>

#include "terrain/raster.h"

enum { PL_RASTER_LEVELS_MAX = 40 };

typedef struct pl_raster_level {
  const void *samples;
  pl_raster_type type;
  size_t stride;
  int width, height;
} pl_raster_level;

struct pl_raster {
  pl_raster_frame frame;
  pl_raster_axis across, down; /* lattices of columns and rows */
  bool wraps;                  /* column `columns` is column 0 */
  bool crosses[2]; /* whether rows continue beyond the pole before the first row, after the last */
  double pole_rows[2]; /* rows of these poles: of a post, or half a post beyond it */
  int columns, rows;   /* without a column that repeats the first */
  double snap_u, snap_v;
  pl_vec3 middle; /* direction of its middle */
  double reach;   /* greatest distance of unit directions on it from there; INFINITY: not known */
  double least, greatest; /* of the samples */
  int level_count;
  pl_raster_level levels[PL_RASTER_LEVELS_MAX];
  float *memory; /* owned; levels from 1 */
};

static inline double pl_raster_sample(const pl_raster_level *level, size_t index) {
  switch (level->type) {
  case PL_RASTER_UINT8:
    return ((const uint8_t *)level->samples)[index];
  case PL_RASTER_INT16:
    return ((const int16_t *)level->samples)[index];
  case PL_RASTER_UINT16:
    return ((const uint16_t *)level->samples)[index];
  default:
    return (double)((const float *)level->samples)[index];
  }
}

static inline double pl_raster_cell(const pl_raster_level *level, int column, int row) {
  return pl_raster_sample(level, (size_t)row * level->stride + (size_t)column);
}

/* Finds the range of the samples, and computes the means of all levels from 1. Returns PL_E_RANGE
 * for a sample that is not finite. */
pl_status pl_raster_fill(pl_raster *raster);

#endif
