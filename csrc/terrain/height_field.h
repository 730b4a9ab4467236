/* The ground of a body in a frame: its tiles, and what a hit on them means.
 *
 * A hit on the ground is the index of a tile and Embree's coordinates u, v on its grid, which count
 * from 0 to 1 across all posts of a row and of a column, the skirt included. A hit on a rock is the
 * index of a triangle among those of all tiles' rocks, and barycentric weights. */
#ifndef PL_TERRAIN_HEIGHT_FIELD_H
#define PL_TERRAIN_HEIGHT_FIELD_H

#include "terrain/ground_tile.h"
#include "terrain/ground_tile_rays.h"
#include "terrain/ground_tile_rocks.h"

typedef struct pl_height_field {
  const pl_terrain *terrain;          /* borrowed */
  const pl_ground_tile *const *tiles; /* borrowed: valid until the tiles are next trimmed */
  size_t count;
  /* Number of triangles of rocks in the tiles before each, and in all; NULL without rocks. */
  const uint32_t *first_rocks;
  /* Origin of the mesh of the ground, body axes, m: mesh units are metres, its axes are the body's.
   */
  pl_vec3 origin;
  void *scene;     /* RTCScene with an instance a tile, of the index of the tile; borrowed */
  double radius_m; /* of a sphere around the body's centre that encloses the ground */
  double widened;  /* factor by which cells are wider than asked, for the limit of tiles; 1: none */
  bool patch_missed; /* no tile of the patch that the terrain states is in the frame */
} pl_height_field;

/* A triangle of a rock. */
typedef struct pl_rock_hit {
  const pl_ground_tile *tile;
  uint32_t triangle; /* of the rock's mesh */
  const pl_ground_rock *rock;
} pl_rock_hit;
pl_rock_hit pl_height_field_rock(const pl_height_field *field, uint32_t triangle);
/* Its corners, relative to `field->origin` in body axes, m. */
void pl_rock_hit_corners(const pl_height_field *field, const pl_rock_hit *hit, pl_vec3 out[3]);
/* The normal interpolated between its corners, body axes, unit, outwards. */
pl_vec3 pl_rock_hit_normal(const pl_rock_hit *hit, const float weights[3]);

/* Place of a hit on the grid of its tile. */
typedef struct pl_height_field_cell {
  int column, row; /* of the cell, from 0 to PL_GROUND_TILE_CELLS - 1; -1 and PL_GROUND_TILE_CELLS
                      on the skirt */
  double x, y;     /* place in it, from 0 to 1 */
} pl_height_field_cell;

pl_height_field_cell pl_height_field_locate(float u, float v);

/* Corners of the triangle that was hit, relative to `field->origin` in body axes, m, ordered so
 * that they turn counter-clockwise seen from above; `weights` returns the barycentric weights of
 * the hit. */
void pl_height_field_corners(const pl_height_field *field, uint32_t tile, float u, float v,
                             pl_vec3 out[3], double weights[3]);
/* The point that was hit, body axes, relative to the centre of the body, m. */
pl_vec3 pl_height_field_point(const pl_height_field *field, uint32_t tile, float u, float v);
/* The normal interpolated between the posts, body axes, unit, outwards: of the whole surface,
 * continuous across cells and tiles. */
pl_vec3 pl_height_field_normal(const pl_height_field *field, uint32_t tile, float u, float v);

/* Excess of brightness by rays of craters at a hit, between its posts; 0 without rays. */
float pl_height_field_rays(const pl_height_field *field, uint32_t tile, float u, float v);

#endif
