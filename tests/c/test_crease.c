/* Normals that were smoothed over hard edges: which are split, and what stays to the bit. */
#include "geom/crease.h"

#include <stdlib.h>

#include "models.h"

#define DEGREES(x) ((x)*PL_PI / 180.0)

typedef struct copy {
  float normals[3 * 256];
  uint32_t indices[3 * 256];
  size_t vertices;
} copy;

static copy copy_of(const pl_model *model) {
  copy out = {.vertices = model->vertex_count};
  assert_true(model->vertex_count <= 256 && model->triangle_count <= 256);
  memcpy(out.normals, model->normals, 3 * model->vertex_count * sizeof(float));
  memcpy(out.indices, model->indices, 3 * model->triangle_count * sizeof(uint32_t));
  return out;
}

static void assert_untouched(const pl_model *model, const copy *before) {
  assert_int_equal(model->vertex_count, before->vertices);
  assert_memory_equal(model->normals, before->normals, 3 * before->vertices * sizeof(float));
  assert_memory_equal(model->indices, before->indices,
                      3 * model->triangle_count * sizeof(uint32_t));
  assert_string_equal(model->warnings, "");
}

/* A tube of `sides` about z with one vertex for all faces of a corner; caps where `capped`. All
 * normals are as exporters make them: the mean of the faces there. */
static pl_model *tube_create(uint32_t sides, bool capped) {
  pl_model *model = model_create(2 * sides, 2 * sides + (capped ? 2 * (sides - 2) : 0));
  for (uint32_t k = 0; k < 2 * sides; k++) {
    const double angle = 2.0 * PL_PI * (k / 2) / sides, top = k % 2 ? 1.0 : -1.0;
    const pl_vec3 out = {cos(angle), sin(angle), capped ? top : 0.0};
    model_set_vertex(model, k, (pl_vec3){cos(angle), sin(angle), top}, pl_vec3_unit(out));
  }
  uint32_t *next = model->indices;
  for (uint32_t k = 0; k < sides; k++) {
    const uint32_t a = 2 * k, b = 2 * ((k + 1) % sides);
    const uint32_t quad[6] = {a, b, b + 1, a, b + 1, a + 1};
    memcpy(next, quad, sizeof quad);
    next += 6;
  }
  for (uint32_t k = 1; capped && k + 1 < sides; k++) {
    const uint32_t caps[6] = {0, 2 * k + 2, 2 * k, 1, 2 * k + 1, 2 * k + 3};
    memcpy(next, caps, sizeof caps);
    next += 6;
  }
  pl_model_measure(model);
  return model;
}

static pl_vec3 corner(const pl_model *model, size_t triangle, size_t k) {
  return model_vertex(model, model->indices[3 * triangle + k]);
}

static pl_vec3 normal_at(const pl_model *model, size_t triangle, size_t k) {
  const float *n = model->normals + 3 * (size_t)model->indices[3 * triangle + k];
  return (pl_vec3){n[0], n[1], n[2]};
}

static pl_vec3 face_of(const pl_model *model, size_t t) {
  return pl_vec3_unit(pl_vec3_cross(pl_vec3_sub(corner(model, t, 1), corner(model, t, 0)),
                                    pl_vec3_sub(corner(model, t, 2), corner(model, t, 0))));
}

/* A box with a vertex a corner: each face gets its own normals, whatever the windings. */
static void test_box(void **state) {
  (void)state;
  for (uint32_t turned = 0; turned < 12; turned += 5) {
    pl_model *model = tube_create(4, true);
    size_t split;
    for (uint32_t t = 0; t < turned; t++) { /* some faces are wound the other way */
      const uint32_t swap = model->indices[3 * t + 1];
      model->indices[3 * t + 1] = model->indices[3 * t + 2];
      model->indices[3 * t + 2] = swap;
    }
    assert_int_equal(pl_model_crease(model, DEGREES(65), &split), PL_OK);
    assert_int_equal(split, 8);
    assert_int_equal(model->vertex_count, 24);
    assert_non_null(strstr(model->warnings, "8 vertices have one normal for faces"));
    for (size_t t = 0; t < model->triangle_count; t++)
      for (size_t k = 0; k < 3; k++)
        assert_true(fabs(pl_vec3_dot(face_of(model, t), normal_at(model, t, k))) > 1.0 - 1e-6);
    const copy after = copy_of(model);
    model->warnings[0] = '\0';
    assert_int_equal(pl_model_crease(model, DEGREES(65), &split), PL_OK);
    assert_int_equal(split, 0);
    assert_untouched(model, &after);
    pl_model_destroy(model);
  }
}

/* A tube of ten sides stays round, and its caps become flat. */
static void test_capped_tube(void **state) {
  (void)state;
  pl_model *model = tube_create(10, true);
  size_t split;
  assert_int_equal(pl_model_crease(model, DEGREES(65), &split), PL_OK);
  assert_int_equal(split, 20);
  assert_int_equal(model->vertex_count, 40);
  for (size_t t = 0; t < model->triangle_count; t++)
    for (size_t k = 0; k < 3; k++) {
      const pl_vec3 p = corner(model, t, k), n = normal_at(model, t, k);
      const pl_vec3 out = t < 20 ? (pl_vec3){p.x, p.y, 0.0} : (pl_vec3){0.0, 0.0, p.z};
      assert_true(pl_vec3_dot(n, out) > 1.0 - 1e-6);
    }
  pl_model_destroy(model);
}

/* Coordinates of texture that differ make other vertices, but no other surface. */
static void test_texture_seam(void **state) {
  (void)state;
  pl_model *model = tube_create(10, true);
  size_t split;
  float **arrays[] = {&model->positions, &model->normals};
  for (int k = 0; k < 2; k++) { /* vertex 20 for vertex 0, in one triangle */
    *arrays[k] = pl_realloc(*arrays[k], 3 * 21, sizeof(float));
    memcpy(*arrays[k] + 60, *arrays[k], 3 * sizeof(float));
  }
  model->uvs[0] = pl_alloc(2 * 21, sizeof(float));
  for (size_t v = 0; v < 21; v++)
    model->uvs[0][2 * v] = (float)v;
  model->vertex_count = 21;
  model->indices[0] = 20;
  assert_int_equal(pl_model_crease(model, DEGREES(65), &split), PL_OK);
  assert_int_equal(split, 20);
  assert_int_equal(model->vertex_count, 41);
  const pl_vec3 seam = normal_at(model, 0, 0), other = normal_at(model, 1, 0);
  assert_true(model->indices[0] != model->indices[3]);
  assert_true(pl_vec3_norm(pl_vec3_sub(seam, other)) == 0.0);
  assert_true(model->uvs[0][2 * model->indices[0]] == 20.0f);
  assert_true(model->uvs[0][2 * model->indices[3]] == 0.0f);
  pl_model_destroy(model);
}

/* What well-made models have: flat faces with vertices of their own, round ones of few sides, edges
 * broken by a chamfer whose normals are those of the faces beside it; and the angle that is off. */
static void test_well_made_models_stay(void **state) {
  (void)state;
  pl_model *models[] = {cube_create(1.0), tube_create(6, false), tube_create(16, false),
                        model_create(8, 6), tube_create(4, true)};
  for (size_t k = 0; k < 8; k++) { /* along x: a face, a chamfer, a face */
    const double y[4] = {-5.0, 0.0, 1.0, 1.0}, z[4] = {1.0, 1.0, 0.0, -5.0};
    model_set_vertex(models[3], k, (pl_vec3){k < 4 ? 0.0 : 9.0, y[k % 4], z[k % 4]},
                     k % 4 < 2 ? (pl_vec3){0, 0, 1} : (pl_vec3){0, 1, 0});
  }
  for (uint32_t k = 0; k < 3; k++) {
    const uint32_t quad[6] = {k, k + 4, k + 5, k, k + 5, k + 1};
    memcpy(models[3]->indices + 6 * k, quad, sizeof quad);
  }
  for (size_t i = 0; i < 5; i++) {
    const copy before = copy_of(models[i]);
    size_t split = 7;
    assert_int_equal(pl_model_crease(models[i], i < 4 ? DEGREES(65) : PL_PI, &split), PL_OK);
    assert_int_equal(split, 0);
    assert_untouched(models[i], &before);
    pl_model_destroy(models[i]);
  }
}

/* Slivers and triangles of a point beside the edge; nothing at all. */
static void test_degenerate(void **state) {
  (void)state;
  size_t split;
  pl_model *box = tube_create(4, true), *none = model_create(0, 0);
  box->indices[1] = box->indices[0];
  box->indices[5] = box->indices[4] = box->indices[3];
  assert_int_equal(pl_model_crease(box, DEGREES(65), &split), PL_OK);
  for (size_t i = 0; i < 3 * box->vertex_count; i++)
    assert_true(isfinite(box->normals[i]));
  assert_int_equal(pl_model_crease(none, DEGREES(65), &split), PL_OK);
  assert_int_equal(split, 0);
  pl_model_destroy(box);
  pl_model_destroy(none);
}

static void *fail_at_zero(void *context, size_t size) {
  long *left = context;
  return (*left)-- == 0 ? NULL : malloc(size);
}

static void test_memory_runs_out(void **state) {
  (void)state;
  pl_status status = PL_E_MEMORY;
  long n = 0;
  for (; status != PL_OK; n++) {
    pl_model *model = tube_create(4, true);
    size_t split;
    long left = n;
    pl_memory_hook(fail_at_zero, &left);
    status = pl_model_crease(model, DEGREES(65), &split);
    pl_memory_hook(NULL, NULL);
    assert_true(status == PL_OK || status == PL_E_MEMORY);
    pl_model_destroy(model);
  }
  assert_true(n > 6);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_box),          cmocka_unit_test(test_capped_tube),
      cmocka_unit_test(test_texture_seam), cmocka_unit_test(test_well_made_models_stay),
      cmocka_unit_test(test_degenerate),   cmocka_unit_test(test_memory_runs_out),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
