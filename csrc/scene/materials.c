/* Material assignment: which graph is on which triangle of an object. */
#include "scene/materials.h"

#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "shade/graph_classes.h"

static pl_status fill(const char *name, const pl_graph *const *graphs, size_t count,
                      const int32_t *triangle_graph, size_t triangles, pl_object_materials *out) {
  void *memory;
  PL_TRY(pl_alloc_or_fail(count, sizeof *out->graphs, "materials of an object", &memory));
  out->graphs = memory;
  out->count = count;
  PL_TRY(pl_alloc_or_fail(triangles, sizeof(int32_t), "materials of triangles", &memory));
  out->triangle_graph = memory;
  for (size_t i = 0; i < count; i++) {
    out->graphs[i] = (pl_object_graph){graphs[i], out->parameter_count};
    out->parameter_count += pl_graph_parameter_count(graphs[i]);
  }
  for (size_t t = 0; t < triangles; t++) {
    const int32_t graph = triangle_graph[t];
    if (graph < -1 || (graph >= 0 && (size_t)graph >= count))
      return pl_fail(PL_E_RANGE, "object '%s': triangle %zu has graph %d of %zu", name, t,
                     (int)graph, count);
    out->triangle_graph[t] = graph;
  }
  out->random = pl_material_random(name);
  return PL_OK;
}

/* A float holds no more than the upper 24 bits. */
float pl_material_random(const char *name) {
  return (float)(pl_hash(PL_HASH_SEED, name, strlen(name)) >> 40) * 0x1p-24f;
}

pl_status pl_object_materials_create(const char *name, const pl_graph *const *graphs, size_t count,
                                     const int32_t *triangle_graph, size_t triangles,
                                     pl_object_materials **out) {
  void *memory;
  *out = NULL;
  PL_TRY(pl_alloc_or_fail(1, sizeof **out, "materials of an object", &memory));
  const pl_status status = fill(name, graphs, count, triangle_graph, triangles, memory);
  if (status == PL_OK)
    *out = memory;
  else
    pl_object_materials_destroy(memory);
  return status;
}

void pl_object_materials_destroy(pl_object_materials *materials) {
  if (materials == NULL)
    return;
  pl_free(materials->graphs);
  pl_free(materials->triangle_graph);
  pl_free(materials);
}

pl_status pl_object_materials_sort(pl_object_materials *materials, const pl_cut *cut) {
  void *memory;
  PL_TRY(pl_alloc_or_fail(cut->whole.triangle_count, sizeof(int32_t), "materials of triangles",
                          &memory));
  int32_t *sorted = memory;
  for (size_t t = 0; t < cut->whole.triangle_count; t++)
    sorted[t] = materials->triangle_graph[cut->original[t]];
  pl_free(materials->triangle_graph);
  materials->triangle_graph = sorted;
  return PL_OK;
}

bool pl_object_materials_classify(const pl_object_materials *materials) {
  for (size_t i = 0; materials != NULL && i < materials->count; i++)
    if (pl_graph_has_levels(materials->graphs[i].graph))
      return true;
  return false;
}
