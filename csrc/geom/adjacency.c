/* Edges are found in a hash table of their ends. */
#include "geom/adjacency.h"

#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "geom/components.h"

/* In the table: no half-edge. In `across`: no other triangle, or several. */
enum { FREE = UINT32_MAX };
static const uint32_t ALONE = UINT32_MAX, SEVERAL = PL_NO_NEIGHBOUR;

typedef struct search {
  const pl_model *model;
  const uint32_t *first; /* vertex at the same position, by vertex */
  uint32_t *table;       /* half-edges; a power of two, at most half full */
  size_t size;
  uint32_t *across;
} search;

/* The ends of a half-edge, the lower vertex first. */
static void ends_of(const search *s, uint32_t half, uint32_t ends[2]) {
  const uint32_t *corner = s->model->indices + (half - half % 3);
  const uint32_t a = s->first[corner[half % 3]], b = s->first[corner[(half + 1) % 3]];
  ends[0] = a < b ? a : b;
  ends[1] = a < b ? b : a;
}

/* Returns the half-edge that was the first with the same ends: this one, if there was none. */
static uint32_t find(const search *s, uint32_t half, const uint32_t ends[2]) {
  size_t slot = (size_t)pl_hash(PL_HASH_SEED, ends, 2 * sizeof *ends) & (s->size - 1);
  for (; s->table[slot] != (uint32_t)FREE; slot = (slot + 1) & (s->size - 1)) {
    uint32_t other[2];
    ends_of(s, s->table[slot], other);
    if (other[0] == ends[0] && other[1] == ends[1])
      return s->table[slot];
  }
  s->table[slot] = half;
  return half;
}

static void join(const search *s, uint32_t half) {
  uint32_t ends[2];
  ends_of(s, half, ends);
  s->across[half] = ends[0] == ends[1] ? SEVERAL : ALONE;
  if (ends[0] == ends[1])
    return;
  const uint32_t other = find(s, half, ends);
  if (other == half)
    return;
  if (s->across[other] == ALONE) {
    s->across[other] = half;
    s->across[half] = other;
    return;
  }
  if (s->across[other] != SEVERAL)
    s->across[s->across[other]] = SEVERAL;
  s->across[other] = s->across[half] = SEVERAL;
}

static pl_status join_all(const pl_model *model, const uint32_t *first, uint32_t *across) {
  search s = {.model = model, .first = first, .size = 16, .across = across};
  const uint32_t count = (uint32_t)(3 * model->triangle_count);
  void *memory;
  while (s.size < 2 * (size_t)count)
    s.size *= 2;
  PL_TRY(pl_alloc_or_fail(s.size, sizeof(uint32_t), "the table of a model's edges", &memory));
  s.table = memset(memory, 0xff, s.size * sizeof(uint32_t));
  for (uint32_t half = 0; half < count; half++)
    join(&s, half);
  pl_free(memory);
  return PL_OK;
}

pl_status pl_adjacency_init(const pl_model *model, pl_adjacency *out) {
  void *first, *across;
  *out = (pl_adjacency){.model = model};
  PL_TRY(pl_alloc_or_fail(3 * model->triangle_count, sizeof(uint32_t), "a model's edges", &across));
  out->across = across;
  pl_status status =
      pl_alloc_or_fail(model->vertex_count, sizeof(uint32_t), "a model's vertices", &first);
  if (status == PL_OK) {
    status = pl_components_weld(model, first);
    if (status == PL_OK)
      status = join_all(model, first, across);
    pl_free(first);
  }
  if (status != PL_OK)
    pl_adjacency_clear(out);
  return status;
}

void pl_adjacency_clear(pl_adjacency *adjacency) {
  pl_free(adjacency->across);
  *adjacency = (pl_adjacency){0};
}

void pl_adjacency_cache_init(pl_adjacency_cache *cache) { *cache = (pl_adjacency_cache){0}; }

void pl_adjacency_cache_clear(pl_adjacency_cache *cache) {
  for (size_t i = 0; i < cache->count; i++) {
    pl_adjacency_clear(cache->items[i]);
    pl_free(cache->items[i]);
  }
  pl_free(cache->items);
  pl_adjacency_cache_init(cache);
}

pl_status pl_adjacency_cache_get(pl_adjacency_cache *cache, const pl_model *model,
                                 const pl_adjacency **out) {
  void *memory;
  for (size_t i = 0; i < cache->count; i++)
    if (cache->items[i]->model == model) {
      *out = cache->items[i];
      return PL_OK;
    }
  pl_adjacency **grown = pl_realloc(cache->items, cache->count + 1, sizeof *grown);
  if (grown == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for a model's edges");
  cache->items = grown;
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_adjacency), "a model's edges", &memory));
  const pl_status status = pl_adjacency_init(model, memory);
  if (status != PL_OK) {
    pl_free(memory);
    return status;
  }
  cache->items[cache->count++] = memory;
  *out = memory;
  return PL_OK;
}
