/* Meshes that rocks share: of each variant of a shape, and level of detail.
 *
 * Vertices are those of the unstretched ball. A rock is an affine image of a mesh, normals
 * included: the normal at a vertex is the sum of those of the triangles around it, each as long as
 * twice the triangle's area, and an affine map takes such sums to such sums. */
#ifndef PL_TERRAIN_ROCK_MESH_H
#define PL_TERRAIN_ROCK_MESH_H

#include <stddef.h>

#include "terrain/rock_shape.h"

typedef struct pl_rock_mesh {
  uint32_t variant; /* its number */
  uint64_t serial;  /* of the measured shape; 0 for drawn ones */
  int lod;
  int vertex_count, triangle_count;
  float (*positions)[3];          /* owned; room for 16 bytes behind */
  float (*normals)[3];            /* outwards, of any length */
  const uint32_t (*triangles)[3]; /* counter-clockwise seen from outside; of the pool */
  float low[3], high[3];          /* box of the vertices */
  void *scene;                    /* RTCScene, of whom keeps the pool; NULL before */
  bool shown;                     /* by a tile, where it is kept track of */
  struct pl_rock_mesh *next;      /* in the slot: of another measured shape with the number */
} pl_rock_mesh;

/* Meshes by variant and level; each stays as long as a tile shows it. */
typedef struct pl_rock_meshes {
  pl_rock_sphere *spheres; /* owned; NULL before the first use */
  pl_rock_mesh **list;     /* owned; in the order in which they were added */
  pl_rock_mesh **slots;    /* of variant and level; owned */
  size_t count;
} pl_rock_meshes;

/* Returns the mesh of a variant, which is added, empty, if there is none. Not thread-safe. */
pl_status pl_rock_meshes_add(pl_rock_meshes *meshes, const pl_rock_variant *variant, int lod,
                             pl_rock_mesh **out);
/* Gives an empty mesh its vertices: of all its variants, this one must be given. Thread-safe for
 * different meshes. */
pl_status pl_rock_mesh_fill(pl_rock_mesh *mesh, const pl_rock_meshes *meshes,
                            const pl_rock_variant *variant);
/* Frees those from index `from` of the list on, all but their scenes. */
void pl_rock_meshes_drop(pl_rock_meshes *meshes, size_t from);
/* Moves those that are not shown to the end of the list; returns the number of others. */
size_t pl_rock_meshes_sort_shown(pl_rock_meshes *meshes);
void pl_rock_meshes_clear(pl_rock_meshes *meshes);

#endif
