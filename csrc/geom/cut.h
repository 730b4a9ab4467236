/* A model split into rigid pieces that move independently: the static part, and the geometry below
 * each moving node. */
#ifndef PL_GEOM_CUT_H
#define PL_GEOM_CUT_H

#include "geom/cover.h"
#include "geom/model.h"

/* Pieces are views of the model: they share its vertices, materials and textures and have their own
 * triangles. Piece 0 has all triangles below no moving node; it may be empty. */
typedef struct pl_cut {
  const pl_model *model; /* borrowed: the model that was split */
  pl_model whole;        /* the model with its triangles sorted by piece */
  pl_model *pieces;      /* owned, `count`; each has the bounds of its own triangles */
  pl_cover *covers;      /* owned: box trees of the pieces */
  size_t count;          /* number of moving nodes + 1 */
  size_t *first; /* owned: first triangle of each piece in `whole`; one more entry ends the last */
  int *nodes;    /* owned: node indices of pieces 1, 2, .. */
  uint32_t *original; /* owned: for each triangle of `whole`, its index in the model */
} pl_cut;

/* Splits the model at `nodes` (unique indices of the model's nodes): a triangle belongs to the
 * nearest of them above it. The model must outlive the cut. */
pl_status pl_cut_create(const pl_model *model, const int *nodes, size_t count, pl_cut **out);
void pl_cut_destroy(pl_cut *cut); /* NULL is allowed */

/* Returns the piece of a triangle of `whole`. */
static inline size_t pl_cut_piece(const pl_cut *cut, uint32_t triangle) {
  size_t low = 0, high = cut->count;
  while (high - low > 1) {
    const size_t middle = low + (high - low) / 2;
    if (cut->first[middle] <= triangle)
      low = middle;
    else
      high = middle;
  }
  return low;
}

#endif
