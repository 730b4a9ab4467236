/* A model cut into pieces that move apart: what stays, and what hangs on each moving node. */
#ifndef PL_GEOM_CUT_H
#define PL_GEOM_CUT_H

#include "geom/cover.h"
#include "geom/model.h"

/* Pieces are views of the model: they share its vertices, materials and textures and have triangles
 * of their own. Piece 0 is everything that hangs on no moving node; it may have no triangle. */
typedef struct pl_cut {
  const pl_model *model; /* borrowed: what was cut */
  pl_model whole;        /* the model with its triangles in the order of the pieces */
  pl_model *pieces;      /* owned, `count`; with bounds of their own triangles */
  pl_cover *covers;      /* owned: of the pieces */
  size_t count;          /* moving nodes + 1 */
  size_t *first;      /* owned: first triangle of each piece in `whole`; one more ends the last */
  int *nodes;         /* owned: of pieces 1, 2, .. */
  uint32_t *original; /* owned: the model's triangle that each one of `whole` was */
} pl_cut;

/* Cuts at `nodes` (each once, of the model's nodes): a triangle belongs to the nearest of them
 * above it. The model must outlive the cut. */
pl_status pl_cut_create(const pl_model *model, const int *nodes, size_t count, pl_cut **out);
void pl_cut_destroy(pl_cut *cut); /* NULL is allowed */

/* Piece of a triangle of `whole`. */
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
