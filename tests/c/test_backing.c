/* Sheets back to back: which faces they are, and that rays meet the one that looks at them. */
#include "trace/backing.h"

#include "harness.h"

#include "traced.h"

/* Two squares back to back, a hair apart: the first at z = 0 looks along +z, the second at
 * `gap` along -z. Above 0 each is behind the other. */
static pl_model *sheets_create(float gap) {
  pl_model *model = model_create(8, 4);
  static const float corners[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  static const uint32_t faces[4][3] = {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}};
  for (size_t v = 0; v < 8; v++) {
    const float p[3] = {corners[v % 4][0], corners[v % 4][1], v < 4 ? 0.0f : gap};
    const float n[3] = {0.0f, 0.0f, v < 4 ? 1.0f : -1.0f};
    memcpy(model->positions + 3 * v, p, sizeof p);
    memcpy(model->normals + 3 * v, n, sizeof n);
  }
  memcpy(model->indices, faces, sizeof faces);
  pl_model_measure(model);
  assert_int_equal(pl_backing_find(model), PL_OK);
  return model;
}

/* The sheet that looks at the ray is hit, whichever is before the other; both are in the way of
 * light from either side, and neither shades the other. */
static void test_sheets_back_to_back(void **state) {
  (void)state;
  static const float gaps[] = {1e-4f, 1e-6f, 0.0f, -1e-6f, -1e-4f};
  for (size_t g = 0; g < 5; g++)
    for (int sides = 1; sides <= 2; sides++) {
      pl_model *model = sheets_create(gaps[g]);
      model->materials[0].double_sided = sides == 2;
      assert_non_null(model->backed);
      world w;
      world_init(&w);
      stage_add_object(&w.stage, model, (pl_vec3){0, 0, 5}, PL_QUAT_IDENTITY, 1.0);
      world_set(&w);
      for (int i = 0; i < 16; i++) {
        const bool above = i & 1, coherent = i & 2, starts = i & 4, aslant = i & 8;
        const double x = aslant ? 0.99 : 0.0;
        pl_ray ray = {.origin = {0.2 - 5.0 * x, 0.1, above ? 10 : 0},
                      .direction = pl_vec3_unit((pl_vec3){x, 0, above ? -1 : 1}),
                      .t_max = INFINITY,
                      .skip_body = PL_NO_BODY,
                      .from_surface = PL_NO_SURFACE};
        if (starts) { /* on the sheet that looks there */
          ray.origin = (pl_vec3){0.2, 0.1, 5.0 + (above ? 0.0 : (double)gaps[g])};
          ray.direction = pl_vec3_unit((pl_vec3){x, 0, above ? 1 : -1});
          ray.from_surface = w.shot.objects[0].id;
          ray.from_triangle = above ? 1 : 3;
        }
        pl_hit hit;
        bool occluded;
        pl_tracer_closest(w.tracer, &ray, &hit, 1, coherent, true);
        pl_tracer_occluded(w.tracer, &ray, &occluded, 1, coherent);
        assert_int_equal(pl_surface_is_none(hit.surface_id), starts);
        assert_int_equal(occluded, !starts);
        if (!starts)
          assert_int_equal(hit.triangle / 2, above ? 0 : 1);
      }
      world_clear(&w);
      pl_model_destroy(model);
    }
}

/* What is no pair: sheets that look the same way, that are farther apart than a hair, that cover
 * each other in part, a decal on a hull, on different nodes; and walls of glass that rays are
 * followed through. */
static void test_what_is_not_back_to_back(void **state) {
  (void)state;
  for (int i = 0; i < 7; i++) {
    pl_model *model = sheets_create(1e-5f);
    pl_free(model->backed);
    model->backed = NULL;
    if (i == 1)
      for (int t = 2; t < 4; t++) {
        const uint32_t swap = model->indices[3 * t + 1];
        model->indices[3 * t + 1] = model->indices[3 * t + 2];
        model->indices[3 * t + 2] = swap;
      }
    for (int v = 4; v < 8; v++) {
      model->positions[3 * v + 2] = i == 2 ? 1e-3f : 1e-5f;
      model->positions[3 * v] += i == 3 ? 0.5f : 0.0f;
      model->positions[3 * v] *= i == 6 ? 0.5f : 1.0f;
      model->positions[3 * v + 1] *= i == 6 ? 0.5f : 1.0f;
    }
    if (i == 4) {
      model->parts = pl_realloc(model->parts, 2, sizeof(pl_part));
      model->parts[1] = (pl_part){.name = pl_strdup("other"), .node = 7};
      model->part_count = 2;
      model->triangle_part[2] = model->triangle_part[3] = 1;
    }
    model->materials[0].layers.solid = i == 5;
    model->materials[0].layers.transmission = i == 5 ? 1.0f : 0.0f;
    pl_model_measure(model);
    assert_int_equal(pl_backing_find(model), PL_OK);
    assert_int_equal(model->backed != NULL, i == 0);
    pl_model_destroy(model);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_sheets_back_to_back),
                                     cmocka_unit_test(test_what_is_not_back_to_back)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
