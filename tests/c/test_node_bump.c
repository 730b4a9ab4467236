/* Bumps: what a footprint hides is in the roughness, or, point by point, in the normal. */
#include "harness.h"

#include "graphs.h"

static const float RADIUS = 0.5f; /* of footprints: folds are a tenth of that */

static void bump_at(float x, float y, float radius, bool pointwise, pl_value out) {
  test_graph g = {0};
  const size_t place = graph_add(&g, "coordinates"), folds = graph_add(&g, "noise");
  const size_t bump = graph_add(&g, "bump");
  graph_link(&g, folds, "vector", place, 0);
  graph_set(&g, folds, "scale", 20.0f, 20.0f, 20.0f);
  graph_set(&g, bump, "distance_m", 0.02f, 0.02f, 0.02f);
  graph_link(&g, bump, "height", folds, 0);
  pl_graph_point point = graph_point(x, y, 0.3f, radius);
  point.pointwise = pointwise;
  graph_value_at(g, bump, 0, &point, out);
}

/* Sums over points: what is hidden, and how far normals lean. */
static void test_pointwise(void **state) {
  (void)state;
  double hidden = 0.0, lean = 0.0, lean_filtered = 0.0;
  for (int i = 0; i < 64; i++) {
    const float x = 0.37f * (float)i, y = 0.53f * (float)i;
    pl_value filtered, there, all;
    bump_at(x, y, RADIUS, false, filtered);
    bump_at(x, y, RADIUS, true, there);
    bump_at(x, y, 0.0f, false, all);
    for (int k = 0; k < 4; k++)
      assert_true(there[k] == all[k]);
    assert_true(there[3] == 0.0f);
    hidden += (double)filtered[3];
    lean += 1.0 - (double)there[2];
    lean_filtered += 1.0 - (double)filtered[2];
  }
  print_message("hidden slopes %.3f; lean %.3f, filtered %.3f\n", hidden, lean, lean_filtered);
  assert_true(hidden > 0.5 && lean > 0.5 && lean_filtered < 0.1 * lean);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_pointwise),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
