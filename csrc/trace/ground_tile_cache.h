/* Tiles of ground with their Embree grids, kept across frames in a hash table. */
#ifndef PL_TRACE_GROUND_TILE_CACHE_H
#define PL_TRACE_GROUND_TILE_CACHE_H

#include "trace/accelerator.h"
#include "trace/height_field.h"

/* A tile that is kept. */
typedef struct pl_kept_tile {
  pl_ground_tile tile;
  uint64_t terrain; /* pl_terrain_number */
  RTCScene scene;   /* owned; borrows the posts of `tile` */
  uint64_t used;    /* frame of its last use */
  uint64_t order;   /* in which tiles were made */
  size_t bytes;
  bool has_rays; /* and counts them in `bytes` */
} pl_kept_tile;

struct pl_ground_tiles {
  pl_kept_tile **list;      /* owned */
  pl_kept_tile **slots;     /* hash table of them, with open addressing */
  size_t count, slot_count; /* slots: 0 or a power of two, at least twice the count */
  pl_rock_meshes meshes;    /* of all rocks of tiles, with their scenes */
  RTCScene *grounds;        /* of the present frame; owned */
  size_t ground_count;
  uint64_t frame, made;
  size_t bytes, limit;
  atomic_llong embree_bytes; /* allocated by the device, for models, too */
};

/* Returns the tiles of the accelerators, made on first use. */
pl_status pl_ground_tiles_open(pl_accelerators *kept, pl_ground_tiles **out);
/* Returns a tile, or NULL. */
pl_kept_tile *pl_ground_tiles_find(const pl_ground_tiles *tiles, uint64_t terrain,
                                   pl_ground_tile_id id);
/* Marks the tiles of a frame as used, and adds those that are not kept, empty, to the end of the
 * list. */
pl_status pl_ground_tiles_add(pl_ground_tiles *tiles, uint64_t terrain,
                              const pl_ground_tile_id *ids, size_t count);
/* Frees the tiles from index `from` of the list on. */
void pl_ground_tiles_drop(pl_ground_tiles *tiles, size_t from);
/* Keeps a scene until tiles are trimmed; takes it in any case. */
pl_status pl_ground_tiles_hold(pl_ground_tiles *tiles, RTCScene scene);

#endif
