/* A few tight boxes that together enclose a model's triangles. They bound where it can project in
 * an image. */
#ifndef PL_ANNOTATE_CLUSTERS_H
#define PL_ANNOTATE_CLUSTERS_H

#include "geom/model.h"

typedef struct pl_cluster {
  float low[3], high[3]; /* model units */
} pl_cluster;

typedef struct pl_clusters {
  const pl_model *model; /* borrowed */
  pl_cluster *boxes; /* every vertex of every triangle lies in one of them; owned by the cache */
  size_t count;
} pl_clusters;

/* Clusters per model, built on first use and cached. */
typedef struct pl_cluster_cache {
  pl_clusters *items; /* owned */
  size_t count;
} pl_cluster_cache;

void pl_cluster_cache_init(pl_cluster_cache *cache);
void pl_cluster_cache_clear(pl_cluster_cache *cache);
/* *out is valid until the cache is cleared; the model must live as long. */
pl_status pl_cluster_cache_get(pl_cluster_cache *cache, const pl_model *model, pl_clusters *out);

#endif
