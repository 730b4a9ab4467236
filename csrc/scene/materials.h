/* Graphs instead of, or around, the materials of an object's model: which triangles have which. */
#ifndef PL_SCENE_MATERIALS_H
#define PL_SCENE_MATERIALS_H

#include <stdint.h>

#include "geom/cut.h"
#include "shade/graph.h"

typedef struct pl_object_graph {
  const pl_graph *graph;  /* borrowed */
  size_t first_parameter; /* in the object's parameters */
} pl_object_graph;

typedef struct pl_object_materials {
  pl_object_graph *graphs; /* owned */
  size_t count;
  int32_t *triangle_graph; /* owned: of each triangle of the model; -1: the model's material */
  size_t parameter_count;  /* of all graphs */
  float random;            /* 0..1, of the object's name */
} pl_object_materials;

/* PL_E_RANGE for a triangle's graph that is not there. `triangle_graph`: `triangles` of them. */
pl_status pl_object_materials_create(const char *name, const pl_graph *const *graphs, size_t count,
                                     const int32_t *triangle_graph, size_t triangles,
                                     pl_object_materials **out);
void pl_object_materials_destroy(pl_object_materials *materials); /* NULL is allowed */
/* A number of a thing's name, 0..1: what sets patterns on things apart. */
float pl_material_random(const char *name);
/* Puts the triangles in the order of a cut's whole. */
pl_status pl_object_materials_sort(pl_object_materials *materials, const pl_cut *cut);

/* The graph on a triangle, or NULL. */
static inline const pl_object_graph *pl_object_materials_at(const pl_object_materials *materials,
                                                            uint32_t triangle) {
  if (materials == NULL || materials->triangle_graph[triangle] < 0)
    return NULL;
  return &materials->graphs[materials->triangle_graph[triangle]];
}

#endif
