/* Rocks for Embree: in the scene of each tile one user geometry, whose items are instances of
 * shared meshes.
 *
 * Embree's own instances cannot be nested below those of tiles (one level in the builds of Debian),
 * and each costs a geometry object: an item here costs a leaf. The hit's primID counts the
 * triangles of all rocks of the tile. */
#ifndef PL_TRACE_ROCK_INSTANCES_H
#define PL_TRACE_ROCK_INSTANCES_H

#include "terrain/ground_tile_rocks.h"
#include "trace/accelerator.h"

/* Attaches the rocks of a tile to its scene; NULL: none. Their meshes must have scenes. */
void pl_rock_instances_attach(const pl_accelerators *kept, RTCScene scene,
                              const pl_ground_rocks *rocks);
/* Makes the scene of a mesh that has its vertices. */
pl_status pl_rock_instances_build(const pl_accelerators *kept, pl_rock_mesh *mesh);
/* Frees the meshes from index `from` of the list on, with their scenes. */
void pl_rock_instances_drop(pl_rock_meshes *meshes, size_t from);

#endif
