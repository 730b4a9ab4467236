/* Rocks of a tile of ground, as one mesh.
 *
 * A rock belongs to the tile in which its centre lies. Those of at least 2 cells of the tile are
 * shown, with triangles about as wide as cells; smaller ones are left to the ground's roughness and
 * albedo. Each rock is a closed mesh. */
#ifndef PL_TERRAIN_GROUND_TILE_ROCKS_H
#define PL_TERRAIN_GROUND_TILE_ROCKS_H

#include "terrain/ground_tile.h"
#include "terrain/rock_field.h"

typedef struct pl_ground_rocks {
  size_t count, vertex_count, triangle_count;
  size_t bytes;          /* of all this */
  double radius_m;       /* of a sphere around the tile's origin that encloses all rocks */
  pl_rock *rocks;        /* in the order of sites */
  uint32_t *first;       /* first triangle of each rock, and the number of triangles */
  float (*positions)[3]; /* relative to the tile's origin, body axes, m; room for 16 bytes behind */
  float (*normals)[3];   /* unit, outwards */
  uint32_t (*triangles)[3]; /* counter-clockwise seen from outside */
} pl_ground_rocks;

/* Makes the rocks of a tile: a pure function of field, terrain and place of the tile. NULL if there
 * are none. */
pl_status pl_ground_rocks_make(const pl_rock_field *field, const pl_terrain *terrain,
                               pl_ground_tile_id id, pl_vec3 origin, pl_ground_rocks **out);
void pl_ground_rocks_destroy(pl_ground_rocks *rocks);

/* Returns the index of the rock of a triangle. */
size_t pl_ground_rocks_of(const pl_ground_rocks *rocks, uint32_t triangle);

#endif
