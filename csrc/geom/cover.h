/* A few boxes that together cover a mesh more tightly than one sphere: what a long boom needs. */
#ifndef PL_GEOM_COVER_H
#define PL_GEOM_COVER_H

#include <stddef.h>

#include "base/status.h"
#include "geom/model.h"

enum { PL_COVER_BOXES_MAX = 2048 };

typedef struct pl_box {
  float low[3], high[3]; /* model units */
} pl_box;

typedef struct pl_cover {
  pl_box *boxes; /* owned */
  size_t count;  /* 0 for an empty mesh */
} pl_cover;

/* Splits the triangles at the middle of their centroids' longest extent until there are enough
 * boxes. Every triangle lies in one of them. */
pl_status pl_cover_init(const pl_model *model, pl_cover *out);
void pl_cover_clear(pl_cover *cover);

#endif
