/* Keeps tiles of ground, and evicts those that were least recently used. */
#include "trace/ground_tile_cache.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "trace/rock_instances.h"

static bool count_bytes(void *user, ssize_t bytes, bool after) {
  (void)after;
  atomic_fetch_add(&((pl_ground_tiles *)user)->embree_bytes, bytes);
  return true;
}

pl_status pl_ground_tiles_open(pl_accelerators *kept, pl_ground_tiles **out) {
  if (kept->ground == NULL) {
    void *memory;
    PL_TRY(pl_alloc_or_fail(1, sizeof(pl_ground_tiles), "tiles of ground", &memory));
    kept->ground = memory;
    kept->ground->limit = PL_GROUND_BYTES;
    rtcSetDeviceMemoryMonitorFunction(kept->device, count_bytes, kept->ground);
  }
  *out = kept->ground;
  return PL_OK;
}

static void release_grounds(pl_ground_tiles *tiles, size_t from) {
  while (tiles->ground_count > from)
    rtcReleaseScene(tiles->grounds[--tiles->ground_count]);
}

static void free_tile(pl_kept_tile *tile) {
  if (tile->scene != NULL)
    rtcReleaseScene(tile->scene);
  pl_ground_rocks_destroy(tile->tile.rocks);
  pl_free(tile->tile.rays);
  pl_free(tile);
}

void pl_ground_tiles_destroy(pl_accelerators *kept) {
  pl_ground_tiles *tiles = kept->ground;
  if (tiles == NULL)
    return;
  release_grounds(tiles, 0);
  for (size_t k = 0; k < tiles->count; k++)
    free_tile(tiles->list[k]);
  pl_rock_instances_drop(&tiles->meshes, 0);
  pl_rock_meshes_clear(&tiles->meshes);
  rtcSetDeviceMemoryMonitorFunction(kept->device, NULL, NULL);
  pl_free(tiles->list);
  pl_free(tiles->slots);
  pl_free(tiles->grounds);
  pl_free(tiles);
  kept->ground = NULL;
}

/* --- hash table ------------------------------------------------------------------------------- */

static bool same(const pl_kept_tile *tile, uint64_t terrain, pl_ground_tile_id id) {
  const pl_ground_tile_id own = tile->tile.id;
  return tile->terrain == terrain && own.i == id.i && own.j == id.j && own.face == id.face &&
         own.level == id.level && own.coarse == id.coarse;
}

/* Returns the slot of a tile, or the empty one where it belongs. */
static pl_kept_tile **slot_of(const pl_ground_tiles *tiles, uint64_t terrain,
                              pl_ground_tile_id id) {
  const uint64_t words[3] = {terrain, id.i | (uint64_t)id.j << 32,
                             id.face | (uint64_t)id.level << 8 | (uint64_t)id.coarse << 16};
  size_t at = (size_t)pl_hash(PL_HASH_SEED, words, sizeof words);
  for (;; at++) {
    pl_kept_tile **slot = &tiles->slots[at & (tiles->slot_count - 1)];
    if (*slot == NULL || same(*slot, terrain, id))
      return slot;
  }
}

static void index_all(pl_ground_tiles *tiles) {
  memset(tiles->slots, 0, tiles->slot_count * sizeof *tiles->slots);
  for (size_t k = 0; k < tiles->count; k++)
    *slot_of(tiles, tiles->list[k]->terrain, tiles->list[k]->tile.id) = tiles->list[k];
}

/* Makes room for more tiles. */
static pl_status reserve(pl_ground_tiles *tiles, size_t more) {
  size_t wanted = tiles->slot_count > 0 ? tiles->slot_count : 1024;
  while (wanted < 2 * (tiles->count + more))
    wanted *= 2;
  if (wanted == tiles->slot_count)
    return PL_OK;
  pl_kept_tile **list = pl_realloc(tiles->list, wanted / 2, sizeof *list);
  if (list == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for tiles of ground");
  tiles->list = list;
  pl_kept_tile **slots = pl_realloc(tiles->slots, wanted, sizeof *slots);
  if (slots == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for tiles of ground");
  tiles->slots = slots;
  tiles->slot_count = wanted;
  index_all(tiles);
  return PL_OK;
}

pl_status pl_ground_tiles_add(pl_ground_tiles *tiles, uint64_t terrain,
                              const pl_ground_tile_id *ids, size_t count) {
  PL_TRY(reserve(tiles, count));
  for (size_t k = 0; k < count; k++) {
    pl_kept_tile **slot = slot_of(tiles, terrain, ids[k]);
    if (*slot == NULL) {
      void *memory;
      PL_TRY(pl_alloc_or_fail(1, sizeof(pl_kept_tile), "a tile of ground", &memory));
      *slot = memory;
      (*slot)->tile.id = ids[k];
      (*slot)->terrain = terrain;
      (*slot)->order = tiles->made++;
      tiles->list[tiles->count++] = *slot;
    }
    (*slot)->used = tiles->frame;
  }
  return PL_OK;
}

pl_kept_tile *pl_ground_tiles_find(const pl_ground_tiles *tiles, uint64_t terrain,
                                   pl_ground_tile_id id) {
  return *slot_of(tiles, terrain, id);
}

pl_status pl_ground_tiles_hold(pl_ground_tiles *tiles, RTCScene scene) {
  RTCScene *grown = pl_realloc(tiles->grounds, tiles->ground_count + 1, sizeof *grown);
  if (grown == NULL) {
    rtcReleaseScene(scene);
    return pl_fail(PL_E_MEMORY, "out of memory for the ground");
  }
  tiles->grounds = grown;
  tiles->grounds[tiles->ground_count++] = scene;
  return PL_OK;
}

/* Frees meshes of rocks that no tile shows any more. */
static void drop_meshes(pl_ground_tiles *tiles) {
  for (size_t k = 0; k < tiles->meshes.count; k++)
    tiles->meshes.list[k]->shown = false;
  for (size_t k = 0; k < tiles->count; k++) {
    const pl_ground_rocks *rocks = tiles->list[k]->tile.rocks;
    for (size_t i = 0; rocks != NULL && i < rocks->count; i++)
      if (rocks->rocks[i].mesh != NULL)
        rocks->rocks[i].mesh->shown = true;
  }
  pl_rock_instances_drop(&tiles->meshes, pl_rock_meshes_sort_shown(&tiles->meshes));
}

void pl_ground_tiles_drop(pl_ground_tiles *tiles, size_t from) {
  for (size_t k = from; k < tiles->count; k++) {
    tiles->bytes -= tiles->list[k]->bytes;
    free_tile(tiles->list[k]);
  }
  tiles->count = from;
  if (tiles->slot_count > 0)
    index_all(tiles);
}

/* The latest use first; of one frame, in the order of places, so that runs repeat. */
static int by_use(const void *a, const void *b) {
  const pl_kept_tile *x = *(pl_kept_tile *const *)a, *y = *(pl_kept_tile *const *)b;
  if (x->used != y->used)
    return x->used > y->used ? -1 : 1;
  return x->order < y->order ? -1 : x->order > y->order;
}

void pl_ground_tiles_trim(pl_accelerators *kept) {
  pl_ground_tiles *tiles = kept->ground;
  if (tiles == NULL)
    return;
  release_grounds(tiles, 0);
  tiles->frame++;
  if (tiles->bytes <= tiles->limit)
    return;
  qsort(tiles->list, tiles->count, sizeof *tiles->list, by_use);
  size_t staying = 0;
  for (size_t bytes = 0; staying < tiles->count; staying++) {
    bytes += tiles->list[staying]->bytes;
    if (bytes > tiles->limit)
      break;
  }
  pl_ground_tiles_drop(tiles, staying);
  drop_meshes(tiles);
}

size_t pl_ground_scenes(const pl_accelerators *kept) {
  return kept->ground != NULL ? kept->ground->ground_count : 0;
}

void pl_ground_scenes_release(pl_accelerators *kept, size_t from) {
  if (kept->ground != NULL)
    release_grounds(kept->ground, from);
}

pl_ground_tiles_use pl_ground_tiles_used(const pl_accelerators *kept) {
  const pl_ground_tiles *tiles = kept->ground;
  if (tiles == NULL)
    return (pl_ground_tiles_use){0};
  return (pl_ground_tiles_use){tiles->count, tiles->bytes, tiles->made, tiles->meshes.count};
}
