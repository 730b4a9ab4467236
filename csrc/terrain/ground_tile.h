/* Tiles of a body's ground: square blocks of lattice cells as grids of posts.
 *
 * A tile of level k has PL_GROUND_TILE_CELLS cells on a side, of the cube lattice of level k +
 * PL_GROUND_TILE_SHIFT (terrain/cube.h). Its posts are rounded to multiples of a power of two below
 * 1e-5 cells, in body axes, and its origin is a multiple of a larger power: tiles that share a post
 * have it at the same place to the bit, and sums with differences of origins are exact in single
 * precision. */
#ifndef PL_TERRAIN_GROUND_TILE_H
#define PL_TERRAIN_GROUND_TILE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "math/vec.h"
#include "terrain/terrain.h"

enum {
  PL_GROUND_TILE_SHIFT = 5,
  PL_GROUND_TILE_CELLS = 1 << PL_GROUND_TILE_SHIFT,
  PL_GROUND_TILE_POSTS = PL_GROUND_TILE_CELLS + 1,
  PL_GROUND_TILE_SIDE = PL_GROUND_TILE_POSTS + 2 /* posts on a side with the skirt */
};

/* Sides and corners at which a tile meets a tile of the next coarser level. West and east are the
 * sides of lower and higher s, south and north those of lower and higher t. A coarser tile beside
 * an edge touches both of its corners, whose bits are set as well. */
enum {
  PL_GROUND_TILE_WEST = 1,
  PL_GROUND_TILE_EAST = 2,
  PL_GROUND_TILE_SOUTH = 4,
  PL_GROUND_TILE_NORTH = 8,
  PL_GROUND_TILE_SOUTH_WEST = 16,
  PL_GROUND_TILE_SOUTH_EAST = 32,
  PL_GROUND_TILE_NORTH_WEST = 64,
  PL_GROUND_TILE_NORTH_EAST = 128
};

typedef struct pl_ground_tile_id {
  uint32_t i, j; /* column (s) and row (t) among the 2^level by 2^level tiles of the face */
  uint8_t face, level;
  uint8_t coarse; /* bits as above */
} pl_ground_tile_id;

/* Returns the level of the lattice of a tile's cells. */
static inline int pl_ground_tile_lattice(pl_ground_tile_id id) {
  return id.level + PL_GROUND_TILE_SHIFT;
}

typedef struct pl_ground_tile {
  pl_ground_tile_id id;
  pl_vec3 origin;      /* near the middle of the tile, body axes, m */
  double radius_m;     /* of a sphere around `origin` that encloses all posts and the skirt */
  double cell_m;       /* nominal width of a cell */
  float low_m, high_m; /* least and greatest height of the posts over the datum */
  double most_m;       /* nothing of the tile is farther from the body's centre */
  float slope_unit;    /* slope that one step of `slopes` stands for */
  struct pl_ground_rocks *rocks; /* its rocks, of whom keeps the tile; NULL for none */
  struct pl_ground_rays *rays;   /* its rays of craters, likewise; NULL for none */
  /* Posts relative to `origin`, m: rows of ascending t, in each ascending s. The outermost ring is
   * a skirt that closes what rounding opens between tiles: it leads from the edge a fraction of a
   * cell outwards, below the neighbour's surface. */
  float positions[PL_GROUND_TILE_SIDE * PL_GROUND_TILE_SIDE][3];
  /* Slopes of the surface at the posts without the skirt, along the axes of pl_ground_tile_axes. */
  int16_t slopes[PL_GROUND_TILE_POSTS * PL_GROUND_TILE_POSTS][2];
} pl_ground_tile;

/* Makes a tile without its rocks: a pure function of terrain and id. Allocates nothing. */
pl_status pl_ground_tile_make(const pl_terrain *terrain, pl_ground_tile_id id, pl_ground_tile *out);

/* Unit axes of slopes at a unit direction on or near a face: perpendicular to each other and to the
 * direction, `east` towards higher s. */
void pl_ground_tile_axes(int face, pl_vec3 direction, pl_vec3 *east, pl_vec3 *north);

#endif
