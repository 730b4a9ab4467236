/* Chooses the tiles that cover a body in a frame.
 *
 * A quadtree on each face of the cube is refined until the cells of each tile are as small as the
 * frame asks; neighbours, across edges of the cube and diagonally, too, differ by at most one
 * level.
 *
 * Seen ground: the area of a cell in the frame is that of a pixel, divided by cells_per_pixel
 * squared, within a factor of 2 (the nearest of the levels). A cell at distance d seen at an
 * elevation e above the ground covers (cell / d)^2 sin e; sin e counts as at least 1/4, since rough
 * ground has slopes that face the camera: at grazing views cells are up to twice as wide as pixels.
 * Ground outside the frame or beyond the horizon has cells PL_TILE_UNSEEN times as wide. Ground
 * that may shade what is seen has cells no wider than half the penumbra that it casts there, or
 * than the cells there. */
#ifndef PL_TERRAIN_TILE_TREE_H
#define PL_TERRAIN_TILE_TREE_H

#include <stdbool.h>

#include "base/memory.h"
#include "terrain/tile.h"

enum {
  PL_TILE_UNSEEN = 16,
  PL_TILE_LIMIT = 16384 /* a reasonable value for pl_tile_view.limit: about 0.5 GB */
};

typedef struct pl_tile_view {
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
  size_t limit;            /* most tiles */
} pl_tile_view;

/* Writes the tiles, ordered along the tree and allocated in the arena. If they would be more than
 * `limit`, all cells are made wider, by steps of sqrt(2), until they are not, or until only what
 * the limit cannot avoid is left; `widened` returns the factor, 1 if the limit was kept. */
pl_status pl_tile_tree_choose(const pl_terrain *terrain, const pl_tile_view *view, pl_arena *arena,
                              pl_tile_id **out, size_t *count, double *widened);

#endif
