/* Small models built in memory: the same memory as a loaded model, freed by pl_model_destroy. */
#ifndef PL_TESTS_MODELS_H
#define PL_TESTS_MODELS_H

#include <string.h>

#include "harness.h"

#include "base/memory.h"
#include "geom/model.h"
#include "random.h"

#define NO_MAP ((pl_texture_slot){.texture = -1, .transform = PL_UV_IDENTITY})

/* Grey 0.5, rough, not metallic, seen from both sides. */
static inline pl_material plain_material(void) {
  return (pl_material){
      .name = pl_strdup("plain"),
      .base_color = {0.5f, 0.5f, 0.5f, 1.0f},
      .roughness = 1.0f,
      .normal_scale = 1.0f,
      .alpha_cutoff = 0.5f,
      .double_sided = true,
      .base_color_map = NO_MAP,
      .metallic_roughness_map = NO_MAP,
      .normal_map = NO_MAP,
      .emissive_map = NO_MAP,
  };
}

/* One part, one plain material; positions, normals and indices are to be filled in. */
static inline pl_model *model_create(size_t vertices, size_t triangles) {
  pl_model *model = pl_alloc(1, sizeof *model);
  assert_non_null(model);
  model->vertex_count = vertices;
  model->triangle_count = triangles;
  model->unit = 1.0;
  model->positions = pl_alloc(3 * vertices + 1, sizeof(float));
  model->normals = pl_alloc(3 * vertices, sizeof(float));
  model->indices = pl_alloc(3 * triangles, sizeof(uint32_t));
  model->triangle_part = pl_alloc(triangles, sizeof(uint32_t));
  model->part_count = model->material_count = 1;
  model->parts = pl_alloc(1, sizeof *model->parts);
  model->materials = pl_alloc(1, sizeof *model->materials);
  model->warnings = pl_strdup("");
  assert_true(model->positions && model->normals && model->indices && model->triangle_part &&
              model->parts && model->materials && model->warnings);
  model->parts[0].name = pl_strdup("part");
  model->materials[0] = plain_material();
  return model;
}

static inline void model_set_vertex(pl_model *model, size_t v, pl_vec3 p, pl_vec3 n) {
  const double position[3] = {p.x, p.y, p.z}, normal[3] = {n.x, n.y, n.z};
  for (size_t k = 0; k < 3; k++) {
    model->positions[3 * v + k] = (float)position[k];
    model->normals[3 * v + k] = (float)normal[k];
  }
}

static inline pl_vec3 model_vertex(const pl_model *model, size_t v) {
  const float *p = model->positions + 3 * v;
  return (pl_vec3){p[0], p[1], p[2]};
}

/* A parallelogram: corner, corner + a, corner + a + b, corner + b; its normal is a x b. Uses
 * vertices 4 face.. and triangles 2 face... */
static inline void model_set_face(pl_model *model, size_t face, pl_vec3 corner, pl_vec3 a,
                                  pl_vec3 b) {
  const pl_vec3 n = pl_vec3_unit(pl_vec3_cross(a, b));
  const uint32_t first = (uint32_t)(4 * face);
  const uint32_t order[6] = {first, first + 1, first + 2, first, first + 2, first + 3};
  model_set_vertex(model, first, corner, n);
  model_set_vertex(model, first + 1, pl_vec3_add(corner, a), n);
  model_set_vertex(model, first + 2, pl_vec3_add(pl_vec3_add(corner, a), b), n);
  model_set_vertex(model, first + 3, pl_vec3_add(corner, b), n);
  memcpy(model->indices + 6 * face, order, sizeof order);
}

/* The square |x|, |y| <= half at z = 0, facing +z. */
static inline pl_model *square_create(double half) {
  pl_model *model = model_create(4, 2);
  model_set_face(model, 0, (pl_vec3){-half, -half, 0}, (pl_vec3){2 * half, 0, 0},
                 (pl_vec3){0, 2 * half, 0});
  pl_model_measure(model);
  return model;
}

static inline pl_model *cube_create(double half) {
  pl_model *model = model_create(24, 12);
  const double h = half, d = 2 * half;
  const pl_vec3 x = {d, 0, 0}, y = {0, d, 0}, z = {0, 0, d};
  const pl_vec3 low = {-h, -h, -h}, high = {h, h, h};
  const pl_vec3 mx = {-d, 0, 0}, my = {0, -d, 0}, mz = {0, 0, -d};
  model_set_face(model, 0, low, y, x);
  model_set_face(model, 1, low, z, y);
  model_set_face(model, 2, low, x, z);
  model_set_face(model, 3, high, mx, my);
  model_set_face(model, 4, high, my, mz);
  model_set_face(model, 5, high, mz, mx);
  pl_model_measure(model);
  return model;
}

/* Unconnected triangles of sides up to 1 in the cube of half side 1. */
static inline pl_model *soup_create(test_random *random, size_t triangles) {
  pl_model *model = model_create(3 * triangles, triangles);
  for (size_t t = 0; t < triangles; t++) {
    pl_vec3 corner[3];
    for (int k = 0; k < 3; k++)
      corner[k] = (pl_vec3){random_range(random, -1, 1), random_range(random, -1, 1),
                            random_range(random, -1, 1)};
    const pl_vec3 a = pl_vec3_scale(pl_vec3_sub(corner[1], corner[0]), 0.5);
    const pl_vec3 b = pl_vec3_scale(pl_vec3_sub(corner[2], corner[0]), 0.5);
    const pl_vec3 n = pl_vec3_unit(pl_vec3_cross(a, b));
    const uint32_t first = (uint32_t)(3 * t);
    model_set_vertex(model, first, corner[0], n);
    model_set_vertex(model, first + 1, pl_vec3_add(corner[0], a), n);
    model_set_vertex(model, first + 2, pl_vec3_add(corner[0], b), n);
    for (uint32_t k = 0; k < 3; k++)
      model->indices[first + k] = first + k;
  }
  pl_model_measure(model);
  return model;
}

#endif
