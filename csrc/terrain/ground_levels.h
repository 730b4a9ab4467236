/* How finely the ground of a frame may be refined: the levels that its plan counts. */
#ifndef PL_TERRAIN_GROUND_LEVELS_H
#define PL_TERRAIN_GROUND_LEVELS_H

#include "terrain/ground_tile_tree.h"

/* Returns a level that no lattice of the tiles of a view is above: from the ground that is nearest
 * to its eye and the size of a pixel there. Of the view, only eye, pixel_rad, cells_per_pixel and
 * finest_m are used; at least 1. Slopes are taken as for the choice of tiles. */
int pl_ground_levels(const pl_terrain *terrain, const pl_ground_tile_view *view);

/* Whether textures of heights have slopes over footprints of samples in a view, of which eye and
 * pixel_rad are used: false only if none has. */
bool pl_ground_textures_seen(const pl_terrain *terrain, const pl_ground_tile_view *view);

#endif
