/* Models of cubes on nodes, as the reader of files would make them. */
#ifndef PL_TESTS_JOINTED_H
#define PL_TESTS_JOINTED_H

#include <stdio.h>

#include "geom/articulation.h"
#include "models.h"
#include "node_globals.h"

typedef struct cube_node {
  int parent; /* before this one, or -1 */
  pl_trs trs;
  bool empty; /* no cube on it */
} cube_node;

static inline pl_trs trs_at(double x, double y, double z) {
  return (pl_trs){{x, y, z}, PL_QUAT_IDENTITY, {1, 1, 1}};
}

/* Turns a model's vertices and normals, and the winding where the map mirrors. */
static inline void model_map(pl_model *model, size_t first_vertex, size_t vertices,
                             size_t first_triangle, size_t triangles, const pl_affine *map) {
  const pl_mat3 normal = pl_mat3_cofactor(map->m);
  const double side = pl_mat3_determinant(map->m) < 0.0 ? -1.0 : 1.0;
  for (size_t v = first_vertex; v < first_vertex + vertices; v++) {
    const float *n = model->normals + 3 * v;
    const pl_vec3 turned = pl_vec3_unit(pl_mat3_mul_vec(normal, (pl_vec3){n[0], n[1], n[2]}));
    model_set_vertex(model, v, pl_affine_apply(map, model_vertex(model, v)),
                     pl_vec3_scale(turned, side));
  }
  for (size_t t = first_triangle; side < 0.0 && t < first_triangle + triangles; t++) {
    const uint32_t swap = model->indices[3 * t + 1];
    model->indices[3 * t + 1] = model->indices[3 * t + 2];
    model->indices[3 * t + 2] = swap;
  }
}

/* Cube k, of half side `half`, is part k on node k; its 24 vertices and 12 triangles are in order.
 * Empty nodes have neither. */
static inline pl_model *jointed_create(const cube_node *nodes, size_t count, double half) {
  pl_model *cube = cube_create(half);
  pl_model *model = model_create(24 * count, 12 * count);
  pl_affine globals[8];
  size_t parts = 0;
  assert_true(count <= 8);
  model->nodes.items = pl_alloc(count, sizeof(pl_node));
  model->nodes.order = pl_alloc(count, sizeof(int));
  model->nodes.count = model->nodes.order_count = count;
  pl_free(model->parts[0].name);
  pl_free(model->parts);
  model->parts = pl_alloc(count, sizeof(pl_part));
  assert_true(model->nodes.items && model->nodes.order && model->parts);
  for (size_t k = 0; k < count; k++) {
    char name[32];
    snprintf(name, sizeof name, "cube %zu", k);
    model->nodes.order[k] = (int)k;
    model->nodes.items[k] = (pl_node){.name = pl_strdup(name),
                                      .parent = nodes[k].parent,
                                      .local = pl_trs_affine(&nodes[k].trs),
                                      .trs = nodes[k].trs};
  }
  node_globals(&model->nodes, NULL, globals);
  for (size_t k = 0; k < count; k++) {
    if (nodes[k].empty)
      continue;
    memcpy(model->positions + 72 * parts, cube->positions, 72 * sizeof(float));
    memcpy(model->normals + 72 * parts, cube->normals, 72 * sizeof(float));
    for (size_t i = 0; i < 36; i++)
      model->indices[36 * parts + i] = cube->indices[i] + (uint32_t)(24 * parts);
    for (size_t t = 12 * parts; t < 12 * (parts + 1); t++)
      model->triangle_part[t] = (uint32_t)parts;
    model_map(model, 24 * parts, 24, 12 * parts, 12, &globals[k]);
    model->parts[parts++] = (pl_part){.name = pl_strdup("cube"), .node = (int)k};
  }
  model->part_count = parts;
  model->vertex_count = 24 * parts;
  model->triangle_count = 12 * parts;
  pl_model_destroy(cube);
  pl_model_measure(model);
  return model;
}

static inline void vec_near(pl_vec3 v, double x, double y, double z) {
  if (!(pl_vec3_norm(pl_vec3_sub(v, (pl_vec3){x, y, z})) < 1e-12))
    fail_msg("(%.15g, %.15g, %.15g) is not (%.15g, %.15g, %.15g)", v.x, v.y, v.z, x, y, z);
}

#endif
