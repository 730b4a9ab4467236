/* Flat places of meshes: those of a cube, of panels apart, of a sphere; every facet in one group.
 */
#include "harness.h"

#include "geom/facets.h"
#include "models.h"

static float size_of(const pl_facet_group *g) {
  return 4.0f * pl_vec3f_norm(g->half[0]) * pl_vec3f_norm(g->half[1]);
}

static void test_square(void **state) {
  (void)state;
  pl_model *model = square_create(0.75);
  pl_facets facets;
  assert_int_equal(pl_facets_init(model, &facets), PL_OK);
  assert_int_equal(facets.count, 1);
  const pl_facet_group *g = &facets.groups[0];
  assert_float_equal(g->area, 2.25f, 1e-5);
  assert_float_equal(size_of(g), 2.25f, 1e-5);
  assert_float_equal(g->normal.z, 1.0f, 1e-6);
  assert_float_equal(pl_vec3f_norm(g->center), 0.0f, 1e-6);
  assert_true(g->spread < 1e-6f);
  pl_facets_clear(&facets);
  pl_model_destroy(model);
}

static void test_cube(void **state) {
  (void)state;
  pl_model *model = cube_create(0.5);
  pl_facets facets;
  bool found[6] = {false};
  assert_int_equal(pl_facets_init(model, &facets), PL_OK);
  assert_int_equal(facets.count, 6);
  for (size_t i = 0; i < 6; i++) {
    const pl_facet_group *g = &facets.groups[i];
    assert_float_equal(size_of(g), 1.0f, 1e-5);
    assert_true(g->spread < 1e-6f);
    /* The middle of a face is half its normal. */
    assert_true(pl_vec3f_norm(pl_vec3f_sub(g->center, pl_vec3f_scale(g->normal, 0.5f))) < 1e-5f);
    const float *n = &g->normal.x;
    for (int axis = 0; axis < 3; axis++)
      if (fabsf(n[axis]) > 0.999f)
        found[2 * axis + (n[axis] > 0.0f)] = true;
  }
  for (int i = 0; i < 6; i++)
    assert_true(found[i]);
  pl_facets_clear(&facets);
  pl_model_destroy(model);
}

/* Panels in one plane with wide gaps are a rectangle each, turned as they are. */
static void test_panels(void **state) {
  (void)state;
  enum { PANELS = 5 };
  const double turn = 0.4;
  const pl_vec3 x = {cos(turn), sin(turn), 0}, y = {-sin(turn), cos(turn), 0};
  pl_model *model = model_create(4 * PANELS, 2 * PANELS);
  for (size_t i = 0; i < PANELS; i++)
    model_set_face(model, i, pl_vec3_scale(x, 4.0 * (double)i), x, pl_vec3_scale(y, 2.0));
  pl_model_measure(model);
  pl_facets facets;
  assert_int_equal(pl_facets_init(model, &facets), PL_OK);
  assert_int_equal(facets.count, PANELS);
  for (size_t i = 0; i < PANELS; i++) {
    assert_float_equal(facets.groups[i].area, 2.0f, 1e-4);
    assert_float_equal(size_of(&facets.groups[i]), 2.0f, 1e-3);
  }
  pl_facets_clear(&facets);
  pl_model_destroy(model);
}

/* Any mesh: areas add up, normals are unit, each rectangle holds its largest facet. */
static void test_soup(void **state) {
  (void)state;
  test_random random = {.seed = 7};
  for (size_t triangles = 1; triangles < 500; triangles = 3 * triangles + 1) {
    pl_model *model = soup_create(&random, triangles);
    pl_facets facets;
    double area = 0.0, whole = 0.0;
    assert_int_equal(pl_facets_init(model, &facets), PL_OK);
    assert_in_range(facets.count, 1, PL_FACET_GROUPS);
    for (size_t i = 0; i < facets.count; i++) {
      const pl_facet_group *g = &facets.groups[i];
      area += (double)g->area;
      assert_float_equal(pl_vec3f_norm(g->normal), 1.0f, 1e-5);
      assert_true(g->triangle < triangles && g->spread >= 0.0f && g->spread < 1.001f);
      for (size_t k = 0; k < 3; k++) {
        const pl_vec3 p = model_vertex(model, model->indices[3 * (size_t)g->triangle + k]);
        const pl_vec3f off = pl_vec3f_sub(pl_vec3_to_float(p), g->center);
        for (int side = 0; side < 2; side++) {
          const float half = pl_vec3f_norm(g->half[side]);
          assert_true(fabsf(pl_vec3f_dot(off, g->half[side])) <= half * (half + 1e-5f));
        }
      }
    }
    for (size_t t = 0; t < triangles; t++) {
      const pl_vec3 a = model_vertex(model, 3 * t), b = model_vertex(model, 3 * t + 1),
                    c = model_vertex(model, 3 * t + 2);
      whole += 0.5 * pl_vec3_norm(pl_vec3_cross(pl_vec3_sub(b, a), pl_vec3_sub(c, a)));
    }
    assert_true(fabs(area - whole) < 1e-4 * whole);
    pl_facets_clear(&facets);
    pl_model_destroy(model);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_square),
      cmocka_unit_test(test_cube),
      cmocka_unit_test(test_panels),
      cmocka_unit_test(test_soup),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
