/* Rays of craters on a tile of ground: their excess of brightness at its posts. */
#ifndef PL_TERRAIN_GROUND_TILE_RAYS_H
#define PL_TERRAIN_GROUND_TILE_RAYS_H

#include "terrain/ground_tile.h"

/* Excess that one step of a post's number stands for. */
#define PL_GROUND_RAYS_UNIT 0x1p-14f

struct pl_ground_rays {
  int16_t posts[PL_GROUND_TILE_POSTS * PL_GROUND_TILE_POSTS];
};

/* Makes the rays of a tile, a pure function of terrain and id; edges beside coarser tiles are as
 * theirs. Freed with pl_free. */
pl_status pl_ground_rays_make(const pl_terrain *terrain, pl_ground_tile_id id,
                              struct pl_ground_rays **out);

#endif
