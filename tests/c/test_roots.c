/* Zeros of functions whose zeros are known. */
#include "harness.h"

#include <math.h>

#include "math/roots.h"
#include "math/vec.h"
#include "random.h"

/* c + a cos(t - phase). */
typedef struct wave {
  double c, a, phase;
} wave;

static double wave_at(const void *context, double t) {
  const wave *w = context;
  return w->c + w->a * cos(t - w->phase);
}

static double wrapped(double t) { return remainder(t, 2.0 * PL_PI); }

/* cos(t - phase) = -c/a: two zeros about the phase, also when they are 1e-6 apart. */
static void test_waves(void **state) {
  (void)state;
  test_random random = {.seed = 11};
  for (int i = 0; i < 20000; i++) {
    const double half = random_scale(&random, 1e-6, 3.0);
    const wave w = {-cos(half), 1.0, random_range(&random, -PL_PI, PL_PI)};
    double roots[4];
    assert_int_equal(pl_roots_find(wave_at, &w, 0.0, 2.0 * PL_PI, true, roots, 4), 2);
    assert_true(roots[0] < roots[1]);
    const double a = wrapped(roots[0] - w.phase), b = wrapped(roots[1] - w.phase);
    const double noise = 1e-15 + 1e-15 / sin(half); /* of f over its slope */
    assert_true(fabs(fabs(a) - half) < noise && fabs(fabs(b) - half) < noise);
    assert_true((a < 0.0) != (b < 0.0));
  }
}

/* No zeros, however near it comes; one that only touches counts as none or as two. */
static void test_none(void **state) {
  (void)state;
  for (int i = 0; i <= 100; i++) {
    const wave above = {1.0 + 1e-12, 1.0, 0.061 * i}, touching = {1.0, 1.0, 0.061 * i};
    double roots[4];
    assert_int_equal(pl_roots_find(wave_at, &above, 0.0, 2.0 * PL_PI, true, roots, 4), 0);
    assert_true(pl_roots_find(wave_at, &touching, 0.0, 2.0 * PL_PI, true, roots, 4) % 2 == 0);
  }
}

static double cubic(const void *context, double t) {
  (void)context;
  return (t - 0.1) * (t - 0.10001) * (t + 0.7);
}

static void test_open_interval(void **state) {
  (void)state;
  double roots[4];
  assert_int_equal(pl_roots_find(cubic, NULL, -1.0, 1.0, false, roots, 4), 3);
  assert_true(fabs(roots[0] + 0.7) < 1e-15);
  assert_true(fabs(roots[1] - 0.1) < 1e-11 && fabs(roots[2] - 0.10001) < 1e-11);
  assert_int_equal(pl_roots_find(cubic, NULL, -1.0, 1.0, false, roots, 1), 1);
  assert_int_equal(pl_roots_find(cubic, NULL, 0.2, 1.0, false, roots, 4), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_waves),
      cmocka_unit_test(test_none),
      cmocka_unit_test(test_open_interval),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
