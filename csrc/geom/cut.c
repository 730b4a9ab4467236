/* Sorts triangles by the nearest moving node above them. */
#include "geom/cut.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

void pl_cut_destroy(pl_cut *cut) {
  if (cut == NULL)
    return;
  pl_free(cut->whole.indices);
  pl_free(cut->whole.triangle_part);
  pl_free(cut->whole.backed);
  for (size_t k = 0; cut->covers != NULL && k < cut->count; k++)
    pl_cover_clear(&cut->covers[k]);
  pl_free(cut->covers);
  pl_free(cut->pieces);
  pl_free(cut->first);
  pl_free(cut->nodes);
  pl_free(cut->original);
  pl_free(cut);
}

static pl_status allocate(pl_cut *cut, size_t triangles) {
  void *memory[7] = {NULL};
  const size_t count[7] = {cut->count,    cut->count + 1, cut->count, triangles,
                           3 * triangles, triangles,      cut->count};
  const size_t size[7] = {sizeof(pl_model), sizeof(size_t),   sizeof(int),     sizeof(uint32_t),
                          sizeof(uint32_t), sizeof(uint32_t), sizeof(pl_cover)};
  for (int i = 0; i < 7; i++)
    memory[i] = pl_alloc(count[i], size[i]);
  cut->pieces = memory[0];
  cut->first = memory[1];
  cut->nodes = memory[2];
  cut->original = memory[3];
  cut->whole.indices = memory[4];
  cut->whole.triangle_part = memory[5];
  cut->covers = memory[6];
  for (int i = 0; i < 7; i++)
    if (memory[i] == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for the pieces of a model");
  if (cut->model->backed == NULL)
    return PL_OK;
  PL_TRY(pl_alloc_or_fail(triangles, 1, "the pieces of a model", &memory[0]));
  cut->whole.backed = memory[0];
  return PL_OK;
}

/* Finds the piece of each node: that of the nearest moving node at or above it. */
static void find_pieces(const pl_cut *cut, size_t *node_piece) {
  const pl_nodes *nodes = &cut->model->nodes;
  for (size_t k = 1; k < cut->count; k++)
    node_piece[cut->nodes[k - 1]] = k;
  for (size_t i = 0; i < nodes->order_count; i++) {
    const int node = nodes->order[i], parent = nodes->items[node].parent;
    if (node_piece[node] == 0 && parent >= 0)
      node_piece[node] = node_piece[parent];
  }
}

static size_t piece_of(const pl_cut *cut, const size_t *node_piece, size_t triangle) {
  const int node = cut->model->parts[cut->model->triangle_part[triangle]].node;
  return node >= 0 ? node_piece[node] : 0;
}

/* Stable counting sort. */
static void sort_triangles(pl_cut *cut, const size_t *node_piece) {
  const pl_model *model = cut->model;
  const size_t triangles = model->triangle_count;
  for (size_t t = 0; t < triangles; t++)
    cut->first[piece_of(cut, node_piece, t) + 1]++;
  for (size_t k = 0; k < cut->count; k++)
    cut->first[k + 1] += cut->first[k];
  for (size_t t = 0; t < triangles; t++)
    cut->original[cut->first[piece_of(cut, node_piece, t)]++] = (uint32_t)t;
  for (size_t k = cut->count; k > 0; k--) /* each entry has become the start of the next piece */
    cut->first[k] = cut->first[k - 1];
  cut->first[0] = 0;
  for (size_t t = 0; t < triangles; t++) {
    const size_t from = cut->original[t];
    memcpy(cut->whole.indices + 3 * t, model->indices + 3 * from, 3 * sizeof(uint32_t));
    cut->whole.triangle_part[t] = model->triangle_part[from];
    if (model->backed != NULL)
      cut->whole.backed[t] = model->backed[from];
  }
}

static void measure(pl_model *piece) {
  for (size_t axis = 0; axis < 3; axis++) {
    piece->bounds_min[axis] = INFINITY;
    piece->bounds_max[axis] = -INFINITY;
    for (size_t i = 0; i < 3 * piece->triangle_count; i++) {
      const float x = piece->positions[3 * (size_t)piece->indices[i] + axis];
      piece->bounds_min[axis] = fminf(piece->bounds_min[axis], x);
      piece->bounds_max[axis] = fmaxf(piece->bounds_max[axis], x);
    }
  }
}

static pl_status fill(pl_cut *cut, const int *nodes) {
  void *node_piece;
  uint32_t *indices = cut->whole.indices, *parts = cut->whole.triangle_part;
  uint8_t *backed = cut->whole.backed;
  for (size_t k = 1; k < cut->count; k++)
    cut->nodes[k - 1] = nodes[k - 1];
  PL_TRY(pl_alloc_or_fail(cut->model->nodes.count, sizeof(size_t), "the pieces of a model",
                          &node_piece));
  find_pieces(cut, node_piece);
  sort_triangles(cut, node_piece);
  pl_free(node_piece);
  cut->whole = *cut->model;
  cut->whole.indices = indices;
  cut->whole.triangle_part = parts;
  cut->whole.backed = backed;
  for (size_t k = 0; k < cut->count; k++) {
    pl_model *piece = &cut->pieces[k];
    *piece = cut->whole;
    piece->indices = indices + 3 * cut->first[k];
    piece->triangle_part = parts + cut->first[k];
    piece->backed = backed != NULL ? backed + cut->first[k] : NULL;
    piece->triangle_count = cut->first[k + 1] - cut->first[k];
    measure(piece);
    PL_TRY(pl_cover_init(piece, &cut->covers[k]));
    PL_TRY(pl_facets_init(piece, &cut->covers[k].facets));
  }
  return PL_OK;
}

pl_status pl_cut_create(const pl_model *model, const int *nodes, size_t count, pl_cut **out) {
  void *memory;
  for (size_t i = 0; i < count; i++)
    if (nodes[i] < 0 || (size_t)nodes[i] >= model->nodes.count)
      return pl_fail(PL_E_RANGE, "node %d: the model has %zu", nodes[i], model->nodes.count);
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_cut), "the pieces of a model", &memory));
  pl_cut *cut = memory;
  cut->model = model;
  cut->count = count + 1;
  pl_status status = allocate(cut, model->triangle_count);
  if (status == PL_OK)
    status = fill(cut, nodes);
  if (status != PL_OK)
    pl_cut_destroy(cut);
  else
    *out = cut;
  return status;
}
