/* The angle between vectors against the library's arctangent. */
#include "harness.h"
#include "math/angle.h"
#include "random.h"

/* Abramowitz and Stegun give 2e-8 for 4.4.49. */
static void test_arctangent(void **state) {
  (void)state;
  for (int i = 0; i <= 100000; i++) {
    const double x = i / 100000.0;
    assert_true(fabs(pl_arctan_unit(x) - atan(x)) < 2e-8);
  }
}

static void test_angle(void **state) {
  (void)state;
  test_random random = {.seed = 91};
  for (int i = 0; i < 100000; i++) {
    const pl_vec3 a = pl_vec3_scale(random_direction(&random), random_range(&random, 0.1, 1e9));
    const double angle =
        i % 2 ? random_range(&random, 0, PL_PI) : PL_PI * (i % 4 / 2) + 1e-7 * i / 1e5;
    const pl_vec3 across = pl_vec3_unit(pl_vec3_cross(a, random_direction(&random)));
    const pl_vec3 b = pl_vec3_madd(pl_vec3_scale(across, sin(angle)), cos(angle), pl_vec3_unit(a));
    const double true_angle = angle > PL_PI ? 2.0 * PL_PI - angle : angle;
    assert_true(fabs(pl_vec3_angle(a, b) - true_angle) < 4e-8);
  }
}

/* Against the library, in all octants and on their bounds. */
static void test_arctangent_of_two(void **state) {
  (void)state;
  for (int i = 0; i <= 100000; i++) {
    const double turn = 2.0 * PL_PI * i / 100000.0 - PL_PI, y = 3e6 * sin(turn),
                 x = 3e6 * cos(turn);
    assert_true(fabs(pl_arctan2(y, x) - atan2(y, x)) < 4e-8);
  }
  const double sides[] = {0.0, 1.0, -1.0, 1e300, -1e-300};
  for (int i = 0; i < 25; i++)
    assert_true(fabs(pl_arctan2(sides[i / 5], sides[i % 5]) - atan2(sides[i / 5], sides[i % 5])) <
                4e-8);
  assert_true(pl_arctan2(-0.0, -2.0) == -PL_PI);
  assert_true(pl_arctan2(NAN, NAN) == 0.0);
}

static void test_edges(void **state) {
  (void)state;
  const pl_vec3 x = {1, 0, 0}, y = {0, 3, 0}, zero = {0, 0, 0};
  assert_true(pl_vec3_angle(x, x) == 0.0);
  assert_true(pl_vec3_angle(x, y) == 0.5 * PL_PI);
  assert_true(pl_vec3_angle(x, pl_vec3_scale(x, -2.0)) == PL_PI);
  assert_true(pl_vec3_angle(x, zero) == 0.0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_arctangent),
      cmocka_unit_test(test_arctangent_of_two),
      cmocka_unit_test(test_angle),
      cmocka_unit_test(test_edges),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
