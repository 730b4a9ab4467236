/* Chooses the tiles that cover a body in a frame.
 *
 * A quadtree on each face of the cube is refined until the cells of each tile are as small as the
 * frame asks. Neighbours, diagonally and across edges of the cube, too, differ by at most one
 * level. The level nearest to the wanted width is taken: cells are 0.7 to 1.4 times as wide.
 *
 * - Seen ground: a cell covers the area of a pixel, divided by the square of cells_per_pixel. A
 *   cell of width c at a distance d, seen at an elevation e above the ground, covers (c / d)^2 sin
 *   e. Rough ground has slopes that face the camera; sin e therefore counts as at least 1/4, and
 *   cells at the horizon are twice as wide as pixels.
 * - Ground that may shade what is seen: a cell is as wide as the penumbra that it casts there,
 *   since heights without what is finer are off by about a tenth of a cell; or up to twice as wide
 *   as the cells there.
 * - Ground beside the patch that a terrain states: not refined, but for its shadows.
 * - Ground outside the frame or beyond the horizon: cells are PL_GROUND_TILE_UNSEEN times as wide
 * as if they were seen. */
#ifndef PL_TERRAIN_GROUND_TILE_TREE_H
#define PL_TERRAIN_GROUND_TILE_TREE_H

#include <stdbool.h>

#include "base/memory.h"
#include "terrain/ground_tile.h"

enum {
  PL_GROUND_TILE_UNSEEN = 16,
  PL_GROUND_TILE_LIMIT = 16384 /* a reasonable value for pl_ground_tile_view.limit: about 0.5 GB */
};

typedef struct pl_ground_tile_view {
  pl_vec3 eye;  /* body axes, m; above the ground */
  pl_vec3 axis; /* unit, body axes */
  /* Cone around `axis` that contains the frame; pi for all directions. */
  double half_angle_rad;
  /* Planes through the eye that bound the frame as well, by unit normals that point inwards. */
  pl_vec3 sides[4];
  int side_count;          /* 0 where the cone alone bounds the frame */
  double pixel_rad;        /* angle that a pixel covers */
  double cells_per_pixel;  /* above 0 */
  double finest_m;         /* no cells are narrower than this; above 0 */
  bool far_casters;        /* refine what may shade what is seen */
  pl_vec3 to_sun;          /* unit, body axes; with far_casters */
  double sun_diameter_rad; /* angular diameter of the sun; with far_casters */
  int finest_level;        /* no lattice is finer than this level; 0: any */
  size_t limit;            /* most tiles */
  bool rays;               /* tiles need the rays of craters (terrain/ground_tile_rays.h) */
} pl_ground_tile_view;

typedef struct pl_ground_tile_choice {
  pl_ground_tile_id *ids; /* ordered along the tree; of the arena */
  size_t count;
  double widened;    /* factor by which cells are wider than asked, for the limit; 1: none */
  bool patch_missed; /* the terrain states a patch, and no tile that touches it is in the frame */
} pl_ground_tile_choice;

/* Chooses the tiles. If they would be more than `limit`, all cells are made wider, by steps of
 * sqrt(2), until they are not, or until only what the limit cannot avoid is left. */
pl_status pl_ground_tile_tree_choose(const pl_terrain *terrain, const pl_ground_tile_view *view,
                                     pl_arena *arena, pl_ground_tile_choice *out);

#endif
