/* Boxes that together hold a model's triangles, few and tight: where on an image it can be. */
#ifndef PL_ANNOTATE_CLUSTERS_H
#define PL_ANNOTATE_CLUSTERS_H

#include "geom/model.h"

typedef struct pl_cluster {
  float low[3], high[3]; /* model units */
} pl_cluster;

typedef struct pl_clusters {
  const pl_model *model; /* borrowed */
  pl_cluster *boxes;     /* every corner of every triangle lies in one; owned by the cache */
  size_t count;
} pl_clusters;

/* Clusters by model, made when first asked for and kept. */
typedef struct pl_cluster_cache {
  pl_clusters *items; /* owned */
  size_t count;
} pl_cluster_cache;

void pl_cluster_cache_init(pl_cluster_cache *cache);
void pl_cluster_cache_clear(pl_cluster_cache *cache);
/* *out stays valid until the cache is cleared; so must the model. */
pl_status pl_cluster_cache_get(pl_cluster_cache *cache, const pl_model *model, pl_clusters *out);

#endif
