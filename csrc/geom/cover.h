/* A tree of boxes about the triangles of a mesh: where the mesh may be, as closely as it is worth
 * to look. */
#ifndef PL_GEOM_COVER_H
#define PL_GEOM_COVER_H

#include <stddef.h>

#include "base/status.h"
#include "geom/facets.h"
#include "geom/model.h"

/* Boxes around one, at most. */
enum { PL_COVER_DEPTH = 13 };

typedef struct pl_box {
  float low[3], high[3]; /* model units */
  uint32_t after;        /* index of the first box that is not inside this one */
  uint32_t first, count; /* its triangles, in pl_cover.triangles */
} pl_box;

typedef struct pl_cover {
  const pl_model *model; /* borrowed */
  /* Owned. The whole mesh first; then each box's first half with all that is in it, and its second.
   * A box with nothing inside is a leaf: its `after` is the next one. */
  pl_box *boxes;
  size_t count;        /* 0 for an empty mesh */
  uint32_t *triangles; /* owned: indices of the model's, each once */
  pl_facets facets;    /* owned: its flat places, of what may mirror; none until they are wanted */
} pl_cover;

/* Splits the triangles at the middle of their centroids' longest extent until few are left, or the
 * tree is deep. */
pl_status pl_cover_init(const pl_model *model, pl_cover *out);
void pl_cover_clear(pl_cover *cover);

#endif
