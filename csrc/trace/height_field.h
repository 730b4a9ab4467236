/* Keeps tiles of ground with their Embree grids across frames, and builds the ground of a frame. */
#ifndef PL_TRACE_HEIGHT_FIELD_H
#define PL_TRACE_HEIGHT_FIELD_H

#include "base/parallel.h"
#include "terrain/height_field.h"
#include "terrain/ground_tile_tree.h"
#include "trace/tracer.h"

/* Tiles are evicted above this many bytes. */
#define PL_GROUND_BYTES ((size_t)512 << 20)

/* More rocks than this may not be expected in the tiles of a frame. They would take some 0.6 GB. */
#define PL_GROUND_ROCKS_MOST 2e6

/* Chooses the tiles of a frame, makes those that are not kept on `threads` threads, and builds the
 * scene of their instances. The ground is allocated in the arena; its scene and tiles are valid
 * until the next pl_ground_tiles_trim. Its bits depend on terrain and view alone. Not thread-safe.
 * `cancel` may be NULL. */
pl_status pl_height_field_build(pl_accelerators *kept, const pl_terrain *terrain,
                                const pl_ground_tile_view *view, int threads, pl_cancel *cancel,
                                pl_arena *arena, const pl_height_field **out);

/* Call at the start of a frame, when no ground is in use any more: releases the scenes of all
 * grounds, and evicts the tiles that were least recently used while all together are above the
 * limit of bytes. */
void pl_ground_tiles_trim(pl_accelerators *kept);

/* Scenes of grounds that are held, and the release of all from one on: of grounds that are not in
 * use any more. Tiles stay. */
size_t pl_ground_scenes(const pl_accelerators *kept);
void pl_ground_scenes_release(pl_accelerators *kept, size_t from);

/* What is kept at present. */
typedef struct pl_ground_tiles_use {
  size_t tiles, bytes; /* bytes with those of Embree */
  uint64_t made;       /* tiles made so far */
  size_t rock_meshes;  /* shared by the rocks of tiles */
} pl_ground_tiles_use;
pl_ground_tiles_use pl_ground_tiles_used(const pl_accelerators *kept);

#endif
