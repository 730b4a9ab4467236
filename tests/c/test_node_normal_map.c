/* Normal maps of graphs against those of glTF materials. */
#include "graphs.h"

#include <math.h>

#include "base/memory.h"
#include "models.h"

/* A square whose image lies in any way on it. */
typedef struct laid {
  pl_model *model;
  float u[2], v[2]; /* change of u and v along x and y */
} laid;

static laid lay(test_random *random) {
  laid l = {.model = square_create(1.0)};
  l.model->uvs[1] = pl_alloc(8, sizeof(float));
  for (int k = 0; k < 2; k++) {
    l.u[k] = (float)random_range(random, -1.0, 1.0);
    l.v[k] = (float)random_range(random, -1.0, 1.0);
  }
  for (size_t i = 0; i < 4; i++) {
    const float *p = l.model->positions + 3 * i;
    l.model->uvs[1][2 * i] = l.u[0] * p[0] + l.u[1] * p[1];
    l.model->uvs[1][2 * i + 1] = l.v[0] * p[0] + l.v[1] * p[1];
  }
  return l;
}

static pl_graph_point point_on(const pl_model *model) {
  pl_graph_point p = graph_point(0.0f, 0.0f, 0.0f, 0.0f);
  p.model = model;
  p.triangle = (pl_triangle_point){.triangle = 1,
                                   .w = {0.3f, 0.3f, 0.4f},
                                   .edge1 = {2.0f, 2.0f, 0.0f},
                                   .edge2 = {0.0f, 2.0f, 0.0f}};
  return p;
}

static pl_vec3f normal_of(const pl_graph_point *p, const float color[3], float strength) {
  test_graph g = {0};
  pl_value v;
  const size_t node = graph_add(&g, "normal_map");
  graph_set(&g, node, "color", color[0], color[1], color[2]);
  graph_set(&g, node, "strength", strength, strength, strength);
  graph_choose(&g, node, "uv", "uv1");
  graph_value_at(g, node, 0, p, v);
  return pl_value_vec(v);
}

/* What the reader of glTF makes of the uvs: t along growing u, and w = 1 where u and v turn
 * clockwise (io/gltf_tangent.cpp, tested there). */
static pl_vec3f normal_of_material(const laid *l, const pl_graph_point *p, const uint8_t codes[3],
                                   float scale) {
  pl_model *model = l->model;
  const float area = l->u[0] * l->v[1] - l->u[1] * l->v[0], sign = area < 0.0f ? -1.0f : 1.0f;
  const pl_vec3f t = pl_vec3f_unit(pl_vec3f_make(sign * l->v[1], -sign * l->v[0], 0.0f));
  pl_image image = {.width = 1, .height = 1, .channels = 3, .texels = pl_alloc(3, 1)};
  pl_texture *texture;
  float tangents[16] = {0};
  memcpy(image.texels, codes, 3);
  assert_int_equal(pl_texture_create(&image, false, PL_WRAP_REPEAT, PL_WRAP_REPEAT, &texture),
                   PL_OK);
  model->textures = &texture;
  model->tangents = tangents;
  model->materials[0].normal_map = (pl_texture_slot){0, 1, PL_UV_IDENTITY};
  model->materials[0].normal_scale = scale;
  pl_surface s = {.t = t,
                  .b = pl_vec3f_scale(pl_vec3f_cross(p->n, t), area < 0.0f ? 1.0f : -1.0f),
                  .n = p->n,
                  .ng = p->n};
  pl_material_surface(model, &p->triangle, PL_DETAIL_FULL, &s);
  model->textures = NULL;
  model->tangents = NULL;
  pl_texture_destroy(texture);
  return s.n;
}

static void test_it_is_the_normal_map_of_a_gltf_material(void **state) {
  (void)state;
  test_random random = {.seed = 8};
  for (int i = 0; i < 200; i++) {
    const laid l = lay(&random);
    const pl_graph_point p = point_on(l.model);
    uint8_t codes[3];
    float color[3];
    for (int k = 0; k < 3; k++) {
      codes[k] = (uint8_t)random_below(&random, 256);
      color[k] = (float)codes[k] / 255.0f;
    }
    const float strength = (float)random_range(&random, -1.0, 2.0);
    const pl_vec3f a = normal_of(&p, color, strength);
    const pl_vec3f b = normal_of_material(&l, &p, codes, strength);
    assert_true(pl_vec3f_norm(pl_vec3f_sub(a, b)) < 1e-4f);
    pl_model_destroy(l.model);
  }
}

/* An object that is mirrored shows its image mirrored: normals follow. */
static void test_mirrored_objects(void **state) {
  (void)state;
  test_random random = {.seed = 9};
  const float color[3] = {0.8f, 0.7f, 0.6f};
  for (int i = 0; i < 50; i++) {
    const laid l = lay(&random);
    pl_graph_point p = point_on(l.model);
    const pl_vec3f plain = normal_of(&p, color, 1.0f);
    p.triangle.edge1.x = -p.triangle.edge1.x; /* x mirrored; the normal is kept outside */
    p.triangle.edge2.x = -p.triangle.edge2.x;
    const pl_vec3f mirrored = normal_of(&p, color, 1.0f);
    assert_true(fabsf(plain.x + mirrored.x) < 1e-5f && fabsf(plain.y - mirrored.y) < 1e-5f &&
                fabsf(plain.z - mirrored.z) < 1e-5f);
    pl_model_destroy(l.model);
  }
}

static void test_flat_cases(void **state) {
  (void)state;
  test_random random = {.seed = 10};
  const float color[3] = {0.9f, 0.3f, 0.7f}, grey[3] = {0.5f, 0.5f, 0.5f};
  const laid l = lay(&random);
  pl_graph_point p = point_on(l.model);
  assert_true(normal_of(&p, color, 0.0f).z == 1.0f);
  assert_true(normal_of(&p, grey, 1.0f).z > 0.99999f); /* of no length */
  assert_true(normal_of(&p, color, 1.0f).z < 0.9f);
  p.radius = INFINITY;
  assert_true(normal_of(&p, color, 1.0f).z == 1.0f);
  p = point_on(l.model);
  p.bumps = false;
  assert_true(normal_of(&p, color, 1.0f).z == 1.0f);
  /* Without, or with squeezed, texture coordinates the frame's own tangents serve. */
  p = point_on(l.model);
  memset(l.model->uvs[1], 0, 8 * sizeof(float));
  const pl_vec3f squeezed = normal_of(&p, color, 1.0f);
  p.model = NULL;
  const pl_vec3f none = normal_of(&p, color, 1.0f);
  const pl_vec3f expected = pl_vec3f_unit(pl_vec3f_make(0.8f, -0.4f, 0.4f));
  assert_true(pl_vec3f_norm(pl_vec3f_sub(squeezed, expected)) < 1e-5f);
  assert_true(pl_vec3f_norm(pl_vec3f_sub(none, expected)) < 1e-5f);
  pl_model_destroy(l.model);
}

static void test_odd_numbers(void **state) {
  (void)state;
  static const float odd[] = {0.0f, 1.0f, -1e30f, 3e38f, 1e-38f};
  const pl_graph_point p = graph_point(0.0f, 0.0f, 0.0f, 0.0f);
  for (int i = 0; i < 625; i++) {
    const float color[3] = {odd[i % 5], odd[i / 5 % 5], odd[i / 25 % 5]};
    const float length = pl_vec3f_norm(normal_of(&p, color, odd[i / 125]));
    assert_true(fabsf(length - 1.0f) < 1e-4f);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_it_is_the_normal_map_of_a_gltf_material),
      cmocka_unit_test(test_mirrored_objects),
      cmocka_unit_test(test_flat_cases),
      cmocka_unit_test(test_odd_numbers),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
