/* Bounding box tree over the triangles of a mesh. It bounds the mesh at the level of detail that a
 * query needs. */
#ifndef PL_GEOM_COVER_H
#define PL_GEOM_COVER_H

#include <stddef.h>

#include "base/status.h"
#include "geom/facets.h"
#include "geom/model.h"

/* Largest depth of the tree. */
enum { PL_COVER_DEPTH = 13 };

typedef struct pl_box {
  float low[3], high[3]; /* model units */
  uint32_t after;        /* index of the first box that is not inside this one */
  uint32_t first, count; /* range of its triangles in pl_cover.triangles */
} pl_box;

typedef struct pl_cover {
  const pl_model *model; /* borrowed */
  /* Owned, in depth-first order: the root first; then each box's first child with all its
   * descendants, and the second child. A box without descendants is a leaf: its `after` is the next
   * index. */
  pl_box *boxes;
  size_t count;        /* 0 for an empty mesh */
  uint32_t *triangles; /* owned: triangle indices of the model, each once */
  /* owned: its planar facet groups, for caustics; empty until they are requested */
  pl_facets facets;
} pl_cover;

/* Splits the triangles at the middle of the largest extent of their centroids until few are left or
 * the depth limit is reached. */
pl_status pl_cover_init(const pl_model *model, pl_cover *out);
void pl_cover_clear(pl_cover *cover);

#endif
