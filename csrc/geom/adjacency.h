/* Which triangles of a model share an edge. */
#ifndef PL_GEOM_ADJACENCY_H
#define PL_GEOM_ADJACENCY_H

#include "base/status.h"
#include "geom/model.h"

/* Half-edges of which no other triangle, or more than one, has the edge, are at least this. */
#define PL_NO_NEIGHBOUR (UINT32_MAX - 1)

typedef struct pl_adjacency {
  const pl_model *model; /* borrowed */
  /* Owned. Half-edge 3 t + k leads from corner k of triangle t to the next; across[3 t + k] is the
   * half-edge of the only other triangle with that edge, whichever way it leads. Vertices at one
   * position are one. */
  uint32_t *across;
} pl_adjacency;

/* PL_E_MEMORY when out of memory. Time is linear in the size of the mesh. */
pl_status pl_adjacency_init(const pl_model *model, pl_adjacency *out);
void pl_adjacency_clear(pl_adjacency *adjacency);

/* Adjacencies by model, built on first use and cached. */
typedef struct pl_adjacency_cache {
  pl_adjacency **items; /* owned */
  size_t count;
} pl_adjacency_cache;

void pl_adjacency_cache_init(pl_adjacency_cache *cache);
void pl_adjacency_cache_clear(pl_adjacency_cache *cache);
/* *out is valid until the cache is cleared; the model must live as long. */
pl_status pl_adjacency_cache_get(pl_adjacency_cache *cache, const pl_model *model,
                                 const pl_adjacency **out);

#endif
