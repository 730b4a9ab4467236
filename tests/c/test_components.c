/* Connected components: counts known by construction, numbering, welding, order of triangles. */
#include "harness.h"

#include <stdlib.h>

#include "geom/components.h"
#include "models.h"

/* Cubes in a row, the k-th cut into `faces[k]` of its faces; all vertices of a face are its own, so
 * that only welding connects them. */
static pl_model *cubes_create(const size_t *faces, size_t cubes) {
  size_t total = 0, face = 0;
  for (size_t k = 0; k < cubes; k++)
    total += faces[k];
  pl_model *model = model_create(4 * total, 2 * total);
  for (size_t k = 0; k < cubes; k++) {
    const double x0 = 3.0 * (double)k - 1.0;
    const pl_vec3 low = {x0, -0.0, 0}, high = {x0 + 1, 1, 1};
    const pl_vec3 x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1};
    const pl_vec3 mx = {-1, 0, 0}, my = {0, -1, 0}, mz = {0, 0, -1};
    const pl_vec3 sides[6][3] = {{low, y, x},    {low, z, y},    {low, x, z},
                                 {high, mx, my}, {high, my, mz}, {high, mz, mx}};
    for (size_t i = 0; i < faces[k]; i++)
      model_set_face(model, face++, sides[i][0], sides[i][1], sides[i][2]);
  }
  pl_model_measure(model);
  return model;
}

static void test_numbered_by_size(void **state) {
  (void)state;
  const size_t faces[4] = {3, 6, 3, 1};
  const uint32_t expected[4] = {1, 0, 2, 3}; /* equal sizes in the order of the file */
  pl_model *model = cubes_create(faces, 4);
  uint32_t component[26];
  size_t count = 0, triangle = 0;
  assert_int_equal(model->triangle_count, 26);
  assert_int_equal(pl_components_find(model, component, &count), PL_OK);
  assert_int_equal(count, 4);
  for (size_t k = 0; k < 4; k++)
    for (size_t i = 0; i < 2 * faces[k]; i++)
      assert_int_equal(component[triangle++], expected[k]);
  pl_model_destroy(model);
}

/* 0 and -0 are one place; neighbouring floats are two. */
static void test_welding(void **state) {
  (void)state;
  pl_model *model = model_create(6, 2);
  const pl_vec3 n = {0, 0, 1};
  for (uint32_t i = 0; i < 6; i++)
    model->indices[i] = i;
  model_set_vertex(model, 0, (pl_vec3){0, 0, 0}, n);
  model_set_vertex(model, 1, (pl_vec3){1, 0, 0}, n);
  model_set_vertex(model, 2, (pl_vec3){0, 1, 0}, n);
  model_set_vertex(model, 3, (pl_vec3){-0.0, 0, -0.0}, n);
  model_set_vertex(model, 4, (pl_vec3){-1, 0, 0}, n);
  model_set_vertex(model, 5, (pl_vec3){0, -1, 0}, n);
  uint32_t component[2];
  size_t count = 0;
  assert_int_equal(pl_components_find(model, component, &count), PL_OK);
  assert_int_equal(count, 1);
  model->positions[3 * 3 + 1] = 1e-30f;
  assert_int_equal(pl_components_find(model, component, &count), PL_OK);
  assert_int_equal(count, 2);
  pl_model_destroy(model);
}

/* A chain of triangles given in random order is one component; without one link it is two whose
 * sizes are those of the two pieces. */
static void test_chain_in_any_order(void **state) {
  (void)state;
  enum { LINKS = 500 };
  test_random random = {.seed = 91};
  pl_model *model = model_create(2 * LINKS + 1, LINKS);
  uint32_t order[LINKS], component[LINKS];
  for (uint32_t i = 0; i < 2 * LINKS + 1; i++)
    model_set_vertex(model, i, (pl_vec3){i, i % 2, 0}, (pl_vec3){0, 0, 1});
  for (uint32_t i = 0; i < LINKS; i++)
    order[i] = i;
  for (uint32_t i = LINKS - 1; i > 0; i--) {
    const uint32_t j = (uint32_t)random_below(&random, (int)i + 1), swap = order[i];
    order[i] = order[j];
    order[j] = swap;
  }
  for (size_t t = 0; t < LINKS; t++)
    for (uint32_t k = 0; k < 3; k++)
      model->indices[3 * t + k] = 2 * order[t] + k;
  size_t count = 0;
  assert_int_equal(pl_components_find(model, component, &count), PL_OK);
  assert_int_equal(count, 1);
  for (size_t t = 0; t < LINKS; t++) /* link 123 becomes a point at its own first corner */
    if (order[t] == 123)
      model->indices[3 * t + 2] = model->indices[3 * t + 1] = model->indices[3 * t];
  assert_int_equal(pl_components_find(model, component, &count), PL_OK);
  assert_int_equal(count, 2);
  for (size_t t = 0; t < LINKS; t++)
    assert_int_equal(component[t], order[t] <= 123 ? 1 : 0);
  pl_model_destroy(model);
}

static void test_empty_mesh(void **state) {
  (void)state;
  pl_model *model = model_create(0, 0);
  size_t count = 7;
  uint32_t none;
  assert_int_equal(pl_components_find(model, &none, &count), PL_OK);
  assert_int_equal(count, 0);
  pl_model_destroy(model);
}

static void *fail_at_zero(void *context, size_t size) {
  long *left = context;
  return (*left)-- == 0 ? NULL : malloc(size);
}

static void test_memory_runs_out(void **state) {
  (void)state;
  pl_model *model = cube_create(1.0);
  uint32_t component[12];
  size_t count;
  for (long n = 0; n < 4; n++) {
    long left = n;
    pl_memory_hook(fail_at_zero, &left);
    const pl_status status = pl_components_find(model, component, &count);
    pl_memory_hook(NULL, NULL);
    assert_int_equal(status, PL_E_MEMORY);
  }
  assert_int_equal(pl_components_find(model, component, &count), PL_OK);
  pl_model_destroy(model);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_numbered_by_size),   cmocka_unit_test(test_welding),
      cmocka_unit_test(test_chain_in_any_order), cmocka_unit_test(test_empty_mesh),
      cmocka_unit_test(test_memory_runs_out),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
