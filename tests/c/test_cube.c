/* The cube's lattice: directions, edges and corners to the bit, back to coordinates, levels. */
#include "harness.h"

#include <math.h>
#include <string.h>

#include "random.h"
#include "terrain/cube.h"

static void test_there_and_back(void **state) {
  (void)state;
  test_random random = {.seed = 1};
  for (int k = 0; k < 2000; k++) {
    const int face = random_below(&random, PL_CUBE_FACES);
    const double s = random_range(&random, -1.0, 1.0), t = random_range(&random, -1.0, 1.0);
    const pl_vec3 d = pl_cube_direction(face, s, t);
    int back;
    double s_back, t_back;
    assert_true(fabs(pl_vec3_norm(d) - 1.0) < 1e-15);
    pl_cube_locate(pl_vec3_scale(d, random_scale(&random, 1e-6, 1e6)), &back, &s_back, &t_back);
    assert_int_equal(back, face);
    assert_true(fabs(s_back - s) < 1e-15 && fabs(t_back - t) < 1e-15);
  }
}

/* Equal steps of s are equal angles; s x t points outwards. */
static void test_axes(void **state) {
  (void)state;
  for (int face = 0; face < PL_CUBE_FACES; face++) {
    const pl_vec3 d = pl_cube_direction(face, 0.0, 0.0);
    const pl_vec3 s = pl_cube_direction(face, 0.5, 0.0), t = pl_cube_direction(face, 0.0, 0.5);
    assert_true(fabs(acos(pl_vec3_dot(d, s)) - PL_PI / 8.0) < 1e-14);
    assert_true(fabs(acos(pl_vec3_dot(d, t)) - PL_PI / 8.0) < 1e-14);
    assert_true(pl_vec3_dot(pl_vec3_cross(s, t), d) > 0.1);
    const double sign = face % 2 == 0 ? 1.0 : -1.0;
    const double main[3] = {d.x, d.y, d.z};
    assert_true(main[face / 2] == sign);
  }
}

/* Every node of an edge has the same bits on both faces: of the nodes of a coarse level that are
 * on edges, 8 corners are met three times, the others twice. */
static void test_edges(void **state) {
  (void)state;
  enum { LEVEL = 4, N = 1 << LEVEL };
  static pl_vec3 found[PL_CUBE_FACES * 4 * N];
  int count = 0, twice = 0, thrice = 0;
  for (int face = 0; face < PL_CUBE_FACES; face++)
    for (int j = 0; j <= N; j++)
      for (int i = 0; i <= N; i++)
        if (i % N == 0 || j % N == 0)
          found[count++] = pl_cube_direction(face, pl_cube_node(LEVEL, i), pl_cube_node(LEVEL, j));
  assert_int_equal(count, PL_CUBE_FACES * 4 * N);
  for (int a = 0; a < count; a++) {
    int same = 0;
    for (int b = 0; b < count; b++)
      same += memcmp(&found[a], &found[b], sizeof found[a]) == 0;
    twice += same == 2;
    thrice += same == 3;
  }
  assert_int_equal(thrice, 3 * 8);
  assert_int_equal(twice, count - 3 * 8);
}

/* Beyond an edge a face continues onto its neighbour. */
static void test_beyond(void **state) {
  (void)state;
  int face;
  double s, t;
  pl_cube_locate(pl_cube_direction(0, 1.25, 0.0), &face, &s, &t);
  assert_int_equal(face, 2);
  assert_true(fabs(s + 0.75) < 1e-14 && fabs(t) < 1e-15);
}

static void test_levels(void **state) {
  (void)state;
  const double radius_m = 1737400.0;
  assert_true(pl_cube_cell_m(0, radius_m) == 0.5 * PL_PI * radius_m);
  for (int level = 0; level < PL_CUBE_LEVELS; level++) {
    const double cell_m = pl_cube_cell_m(level, radius_m);
    assert_int_equal(pl_cube_level(cell_m, radius_m), level);
    if (level > 0)
      assert_int_equal(pl_cube_level(1.001 * cell_m, radius_m), level);
  }
  assert_int_equal(pl_cube_level(1e-30, radius_m), PL_CUBE_LEVELS - 1);
  assert_int_equal(pl_cube_level(1e30, radius_m), 0);
  assert_true(pl_cube_node(3, 0) == -1.0 && pl_cube_node(3, 8) == 1.0);
  assert_true(pl_cube_node(40, 1) == -1.0 + 0x1p-39);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_there_and_back), cmocka_unit_test(test_axes),
      cmocka_unit_test(test_edges),          cmocka_unit_test(test_beyond),
      cmocka_unit_test(test_levels),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
