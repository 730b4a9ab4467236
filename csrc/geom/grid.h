/* Grids of numbers over a whole body, filtered by the footprint of a ray. */
#ifndef PL_GEOM_GRID_H
#define PL_GEOM_GRID_H

#include <stddef.h>

#include "base/status.h"

enum { PL_GRID_CHANNELS_MAX = 32 };

typedef struct pl_grid pl_grid;

/* Layout of the cells: the full circle of longitude from `west_rad` eastwards, and latitudes from
 * `north_rad` down to `south_rad`; all cells have the same angular size. */
typedef struct pl_grid_frame {
  int width, height, channels;
  double west_rad, north_rad, south_rad;
} pl_grid_frame;

/* Copies values[height][width][channels]. Returns PL_E_RANGE for an empty or upside-down frame, and
 * for values that are not finite. */
pl_status pl_grid_create(const pl_grid_frame *frame, const float *values, pl_grid **out);
void pl_grid_destroy(pl_grid *grid);
const pl_grid_frame *pl_grid_frame_of(const pl_grid *grid);

/* Writes the mean over a circle of diameter `size_rad` around a point, `channels` values, with
 * linear interpolation between cell centres and between levels. Beyond the north and south edges
 * the value is the mean of the edge over a circle, which grows with the distance: no single cell is
 * stretched to the pole. */
void pl_grid_sample(const pl_grid *grid, double lon_rad, double lat_rad, double size_rad,
                    float *out);
/* Returns the mean of all cells (not weighted by latitude). */
const float *pl_grid_mean(const pl_grid *grid);
/* Returns the unfiltered values of a cell. */
const float *pl_grid_cell(const pl_grid *grid, int x, int y);

#endif
