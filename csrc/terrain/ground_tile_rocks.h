/* Rocks of a tile of ground, as places of shared meshes.
 *
 * A rock belongs to the tile in which its centre lies. Those of at least 2 cells of the tile are
 * shown, with triangles about as wide as cells; smaller ones are left to the ground's roughness and
 * albedo. Each rock is an affine image of a closed mesh (terrain/rock_mesh.h). */
#ifndef PL_TERRAIN_GROUND_TILE_ROCKS_H
#define PL_TERRAIN_GROUND_TILE_ROCKS_H

#include "terrain/ground_tile.h"
#include "terrain/rock_field.h"
#include "terrain/rock_mesh.h"

typedef struct pl_ground_rock {
  pl_rock rock;
  pl_vec3 stretch;                /* m along the axes of the shape that a unit of its mesh takes */
  const pl_rock_variant *variant; /* borrowed of the field */
  pl_rock_mesh *mesh;             /* borrowed of the pool, once rocks are linked */
  int lod;
} pl_ground_rock;

typedef struct pl_ground_rocks {
  size_t count, triangle_count;
  size_t bytes;          /* of all this, without meshes */
  double radius_m;       /* of a sphere around the tile's origin that encloses all rocks */
  pl_vec3 origin;        /* of the tile */
  pl_ground_rock *rocks; /* in the order of sites */
  uint32_t *first;       /* first triangle of each rock, and the number of triangles */
} pl_ground_rocks;

/* Makes the rocks of a tile: a pure function of field, terrain and place of the tile. NULL if there
 * are none. */
pl_status pl_ground_rocks_make(const pl_rock_field *field, const pl_terrain *terrain,
                               pl_ground_tile_id id, pl_vec3 origin, pl_ground_rocks **out);
/* Number of rocks to be expected in a tile on a sphere by the law, without those about craters. */
double pl_ground_rocks_expected(const pl_rock_field *field, double radius_m, pl_ground_tile_id id);
/* Gives each rock its mesh of the pool. Meshes that are new there are still empty. */
pl_status pl_ground_rocks_link(pl_ground_rocks *rocks, pl_rock_meshes *meshes);
void pl_ground_rocks_destroy(pl_ground_rocks *rocks);

/* Returns the index of the rock of a triangle. */
size_t pl_ground_rocks_of(const pl_ground_rocks *rocks, uint32_t triangle);

/* From mesh units to body axes about the rock's centre, m; and back. */
pl_vec3 pl_ground_rock_out(const pl_ground_rock *rock, pl_vec3 p);
pl_vec3 pl_ground_rock_in(const pl_ground_rock *rock, pl_vec3 p);
/* A normal in mesh units, turned to body axes, of any length. */
pl_vec3 pl_ground_rock_normal(const pl_ground_rock *rock, pl_vec3 normal);

#endif
