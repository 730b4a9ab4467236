/* Which tiles of one level touch, on a face and across the edges of the cube. */
#ifndef PL_TERRAIN_GROUND_TILE_NEIGHBOR_H
#define PL_TERRAIN_GROUND_TILE_NEIGHBOR_H

#include <stdbool.h>
#include <stdint.h>

#include "terrain/cube.h"

/* Sides in the order of the bits of pl_ground_tile_id.coarse: west, east, south, north. */
enum { PL_GROUND_TILE_SIDES = 4 };

/* What lies beyond a side of a face: the face there, the side of it that is shared, and whether
 * positions along the side count backwards. */
typedef struct pl_cube_seam {
  int face, side;
  bool reversed;
} pl_cube_seam;

typedef struct pl_cube_seams {
  pl_cube_seam of[PL_CUBE_FACES][PL_GROUND_TILE_SIDES];
} pl_cube_seams;

void pl_cube_seams_find(pl_cube_seams *out);

/* A tile of a level by its place alone. */
typedef struct pl_ground_tile_place {
  int face;
  int64_t i, j;
} pl_ground_tile_place;

/* Finds the tile `di`, `dj` (each -1, 0 or 1) beside one of the same level. Returns false beyond a
 * corner of the cube, where there is none. */
bool pl_ground_tile_neighbor(const pl_cube_seams *seams, int level, pl_ground_tile_place from,
                             int di, int dj, pl_ground_tile_place *out);

#endif
