/* The ground in view, for channels that need more of it than the point of one pixel: neighbours in
 * the picture, or heights around the point.
 *
 * Points are gathered from tiles while a frame renders, then rows of the channels are written. */
#ifndef PL_ANNOTATE_GROUND_MAP_H
#define PL_ANNOTATE_GROUND_MAP_H

#include "annotate/channel.h"

/* Rows that are written at once. */
enum { PL_GROUND_ROWS = 8 };

/* What a pixel sees. */
typedef struct pl_ground_point {
  pl_vec3 position;   /* from the body's centre, body axes, m */
  double elevation_m; /* over its ellipsoid */
  int32_t body;       /* index among those of the snapshot; -1: no body is seen */
} pl_ground_point;

typedef struct pl_ground_map {
  const pl_snapshot *shot; /* of the bodies */
  pl_ground_point *points; /* a pixel each, row by row */
  void *const *images;     /* indexed as pl_channels; those of other channels are ignored */
} pl_ground_map;

/* Whether any of the images is of a channel that needs a map. */
bool pl_ground_map_needed(void *const *images);

/* Takes the points of a tile, with `stride` points a row. `tile`: x0, y0, width, height. `shot`:
 * that of the tile's instant. */
void pl_ground_map_take(const pl_ground_map *map, const pl_snapshot *shot, const pl_vertex *points,
                        size_t stride, const int tile[4]);

/* Writes rows y0 to y1 - 1 of all images. */
pl_status pl_ground_map_write(const pl_ground_map *map, int y0, int y1);

#endif
