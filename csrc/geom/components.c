/* Finds connected components by union-find over vertices welded by position. */
#include "geom/components.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"

#define NONE UINT32_MAX

/* Returns the root of a vertex's tree and makes every second node on the path point to its
 * grandparent (path halving, Tarjan and van Leeuwen 1984). */
static uint32_t find(uint32_t *parent, uint32_t v) {
  while (parent[v] != v) {
    parent[v] = parent[parent[v]];
    v = parent[v];
  }
  return v;
}

/* Merges two trees. The smaller index becomes the root, so that the result does not depend on the
 * order of the unions. */
static void unite(uint32_t *parent, uint32_t a, uint32_t b) {
  a = find(parent, a);
  b = find(parent, b);
  if (a < b)
    parent[b] = a;
  else
    parent[a] = b;
}

static void position_of(const pl_model *model, size_t v, float out[3]) {
  for (size_t k = 0; k < 3; k++)
    out[k] = model->positions[3 * v + k] + 0.0f; /* turns -0 into 0, whose bits differ */
}

/* Size of the hash table of positions (open addressing), which is at most half full. */
static size_t table_size(size_t vertices) {
  size_t size = 16;
  while (size < 2 * vertices)
    size *= 2;
  return size;
}

pl_status pl_components_weld(const pl_model *model, uint32_t *first) {
  const size_t size = table_size(model->vertex_count);
  void *memory;
  PL_TRY(pl_alloc_or_fail(size, sizeof(uint32_t), "the table of a model's positions", &memory));
  uint32_t *table = memory;
  memset(table, 0xff, size * sizeof *table);
  for (size_t v = 0; v < model->vertex_count; v++) {
    float p[3], other[3];
    position_of(model, v, p);
    size_t slot = (size_t)pl_hash(PL_HASH_SEED, p, sizeof p) & (size - 1);
    first[v] = (uint32_t)v;
    for (; table[slot] != NONE; slot = (slot + 1) & (size - 1)) {
      position_of(model, table[slot], other);
      if (memcmp(p, other, sizeof p) == 0)
        break;
    }
    if (table[slot] == NONE)
      table[slot] = (uint32_t)v;
    else
      first[v] = table[slot];
  }
  pl_free(table);
  return PL_OK;
}

typedef struct component {
  uint32_t triangles, first; /* first: number in the order of first triangles */
} component;

static int by_size(const void *a, const void *b) {
  const component *x = a, *y = b;
  if (x->triangles != y->triangles)
    return x->triangles < y->triangles ? 1 : -1;
  return x->first < y->first ? -1 : x->first > y->first;
}

/* Numbers the roots in the order of their first triangle and writes the numbers to
 * triangle_component; number_of is scratch memory of one entry per vertex. */
static size_t number_by_first(const pl_model *model, uint32_t *parent, uint32_t *number_of,
                              uint32_t *triangle_component) {
  size_t count = 0;
  memset(number_of, 0xff, model->vertex_count * sizeof *number_of);
  for (size_t t = 0; t < model->triangle_count; t++) {
    const uint32_t root = find(parent, model->indices[3 * t]);
    if (number_of[root] == NONE)
      number_of[root] = (uint32_t)count++;
    triangle_component[t] = number_of[root];
  }
  return count;
}

static pl_status renumber_by_size(size_t triangles, size_t count, uint32_t *triangle_component) {
  void *memory, *order;
  PL_TRY(pl_alloc_or_fail(count, sizeof(component), "a model's components", &memory));
  const pl_status status =
      pl_alloc_or_fail(count, sizeof(uint32_t), "the order of a model's components", &order);
  if (status == PL_OK) {
    component *list = memory;
    uint32_t *new_number = order;
    for (size_t i = 0; i < count; i++)
      list[i].first = (uint32_t)i;
    for (size_t t = 0; t < triangles; t++)
      list[triangle_component[t]].triangles++;
    qsort(list, count, sizeof *list, by_size);
    for (size_t i = 0; i < count; i++)
      new_number[list[i].first] = (uint32_t)i;
    for (size_t t = 0; t < triangles; t++)
      triangle_component[t] = new_number[triangle_component[t]];
    pl_free(order);
  }
  pl_free(memory);
  return status;
}

pl_status pl_components_find(const pl_model *model, uint32_t *triangle_component, size_t *count) {
  void *memory;
  PL_TRY(
      pl_alloc_or_fail(model->vertex_count, 2 * sizeof(uint32_t), "a model's vertices", &memory));
  uint32_t *parent = memory;
  pl_status status = pl_components_weld(model, parent);
  if (status == PL_OK) {
    for (size_t t = 0; t < model->triangle_count; t++) {
      unite(parent, model->indices[3 * t], model->indices[3 * t + 1]);
      unite(parent, model->indices[3 * t], model->indices[3 * t + 2]);
    }
    *count = number_by_first(model, parent, parent + model->vertex_count, triangle_component);
    status = renumber_by_size(model->triangle_count, *count, triangle_component);
  }
  pl_free(memory);
  return status;
}
