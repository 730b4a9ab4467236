/* Material assignment on objects: which triangles have which graph, in place of or on top of the
 * materials of the model. */
#ifndef PL_SCENE_MATERIALS_H
#define PL_SCENE_MATERIALS_H

#include <stdint.h>

#include "geom/cut.h"
#include "shade/graph.h"

typedef struct pl_object_graph {
  const pl_graph *graph;  /* borrowed */
  size_t first_parameter; /* offset in the object's parameters */
} pl_object_graph;

typedef struct pl_object_materials {
  pl_object_graph *graphs; /* owned */
  size_t count;
  int32_t *triangle_graph; /* owned: per triangle of the model; -1: the model's material */
  size_t parameter_count;  /* sum over all graphs */
  float random;            /* 0..1, derived from the object's name */
} pl_object_materials;

/* Returns PL_E_RANGE if a triangle's graph does not exist. `triangle_graph` has `triangles`
 * elements. */
pl_status pl_object_materials_create(const char *name, const pl_graph *const *graphs, size_t count,
                                     const int32_t *triangle_graph, size_t triangles,
                                     pl_object_materials **out);
void pl_object_materials_destroy(pl_object_materials *materials); /* NULL is allowed */
/* Returns a number in 0..1 derived from a name, which decorrelates the patterns of different
 * entities. */
float pl_material_random(const char *name);
/* Reorders the triangles to match the whole of a cut. */
pl_status pl_object_materials_sort(pl_object_materials *materials, const pl_cut *cut);

/* Returns whether any graph gives classes of labels (shade/graph_classes.h); NULL: none. */
bool pl_object_materials_classify(const pl_object_materials *materials);
/* Returns the graph on a triangle, or NULL. */
static inline const pl_object_graph *pl_object_materials_at(const pl_object_materials *materials,
                                                            uint32_t triangle) {
  if (materials == NULL || materials->triangle_graph[triangle] < 0)
    return NULL;
  return &materials->graphs[materials->triangle_graph[triangle]];
}

#endif
