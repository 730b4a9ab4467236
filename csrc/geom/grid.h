/* Maps of numbers over a whole body, filtered by the footprint of a ray. */
#ifndef PL_GEOM_GRID_H
#define PL_GEOM_GRID_H

#include <stddef.h>

#include "base/status.h"

enum { PL_GRID_CHANNELS_MAX = 32 };

typedef struct pl_grid pl_grid;

/* Where cells lie: all around in longitude from `west_rad` eastwards, and in latitude from
 * `north_rad` down to `south_rad`; cells of one size in angle. */
typedef struct pl_grid_frame {
  int width, height, channels;
  double west_rad, north_rad, south_rad;
} pl_grid_frame;

/* Copies values[height][width][channels]. PL_E_RANGE for a frame that is empty or upside down, and
 * for values that are not finite. */
pl_status pl_grid_create(const pl_grid_frame *frame, const float *values, pl_grid **out);
void pl_grid_destroy(pl_grid *grid);
const pl_grid_frame *pl_grid_frame_of(const pl_grid *grid);

/* The mean over a circle of `size_rad` across about a point, `channels` values: linear between cell
 * centres and between halved grids. Beyond the north and south edge that of the edge, over a circle
 * that grows with the way from it, so that no cell is drawn out to the pole. */
void pl_grid_sample(const pl_grid *grid, double lon_rad, double lat_rad, double size_rad,
                    float *out);
/* The mean of all cells (not weighted by latitude). */
const float *pl_grid_mean(const pl_grid *grid);
/* The cell's own values. */
const float *pl_grid_cell(const pl_grid *grid, int x, int y);

#endif
