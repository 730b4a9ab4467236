/* Bumps are those of the point, however much of the surface a footprint holds. */
#include "harness.h"

#include "graphs.h"

static const float RADIUS = 0.5f; /* of footprints: folds are a tenth of that */

static void bump_at(float x, float y, float radius, pl_value out) {
  test_graph g = {0};
  const size_t place = graph_add(&g, "coordinates"), folds = graph_add(&g, "noise");
  const size_t bump = graph_add(&g, "bump");
  graph_link(&g, folds, "vector", place, 0);
  graph_set(&g, folds, "scale", 20.0f, 20.0f, 20.0f);
  graph_set(&g, bump, "distance_m", 0.02f, 0.02f, 0.02f);
  graph_link(&g, bump, "height", folds, 0);
  const pl_graph_point point = graph_point(x, y, 0.3f, radius);
  graph_value_at(g, bump, 0, &point, out);
}

/* Slopes are the mean over samples, not of what a wide footprint leaves of them. */
static void test_normals_are_those_of_the_point(void **state) {
  (void)state;
  double lean = 0.0;
  for (int i = 0; i < 64; i++) {
    const float x = 0.37f * (float)i, y = 0.53f * (float)i;
    pl_value wide, narrow;
    bump_at(x, y, RADIUS, wide);
    bump_at(x, y, 0.0f, narrow);
    for (int k = 0; k < 4; k++)
      assert_true(wide[k] == narrow[k]);
    lean += 1.0 - (double)wide[2];
  }
  print_message("lean %.3f\n", lean);
  assert_true(lean > 0.5);
}

/* `surface_maps` off: every pattern is its mean, which has no slopes. */
static void test_a_mean_has_no_slopes(void **state) {
  (void)state;
  pl_value mean;
  bump_at(0.37f, 0.53f, INFINITY, mean);
  assert_true(mean[0] == 0.0f && mean[1] == 0.0f && mean[2] == 1.0f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_normals_are_those_of_the_point),
      cmocka_unit_test(test_a_mean_has_no_slopes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
