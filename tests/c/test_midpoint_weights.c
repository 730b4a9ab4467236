/* Midpoint displacement: weights, and variances beside those of the mean of four neighbours. */
#include "harness.h"

#include <math.h>

#include "terrain/midpoint_weights.h"

/* What the mean of four corners leaves open: S(1)(2^-H - 1/4 - 2^(H-3)), the variance of
 * diamond-square. */
static double of_four(double hurst) { return exp2(-hurst) - 0.25 - exp2(hurst - 3.0); }

/* Sixteen neighbours leave less open than the best four, but not much: the nearest tell most. */
static void test_variances(void **state) {
  (void)state;
  const double exponents[] = {0.0, 0.3, 0.5, 0.76, 0.95};
  for (size_t n = 0; n < sizeof exponents / sizeof exponents[0]; n++) {
    const double hurst = exponents[n];
    const pl_midpoint diamond = pl_midpoint_make(hurst, 1.0, PL_MIDPOINT_DIAMOND);
    const pl_midpoint square = pl_midpoint_make(hurst, 1.0, PL_MIDPOINT_SQUARE);
    assert_true(diamond.variance < of_four(hurst));
    assert_true(diamond.variance > (hurst < 0.9 ? 0.6 : 0.3) * of_four(hurst));
    /* The lattice of squares is that of diamonds, turned and sqrt(2) finer. */
    assert_true(fabs(square.variance - exp2(-hurst) * diamond.variance) < 1e-9);
    for (int k = 0; k < PL_MIDPOINT_AROUND; k++)
      assert_true(fabs(square.weights[k] - diamond.weights[k]) < 1e-7);
  }
  /* White noise: the mean of all, of which each tells as much. */
  const pl_midpoint white = pl_midpoint_make(0.0, 1.0, PL_MIDPOINT_DIAMOND);
  assert_true(fabs(white.variance - (0.5 + 0.5 / 16.0)) < 1e-9);
  assert_true(pl_midpoint_make(1.0, 1.0, PL_MIDPOINT_DIAMOND).variance < 1e-9);
}

/* Weights keep constants and planes, for cells of any ratio, and are symmetric. */
static void test_weights(void **state) {
  (void)state;
  for (double hurst = 0.0; hurst <= 1.0; hurst += 0.25)
    for (double ratio = 1.0 / 16.0; ratio <= 4.0; ratio *= 2.0)
      for (int step = 0; step < 2; step++) {
        const pl_midpoint at = pl_midpoint_make(hurst, ratio, (pl_midpoint_step)step);
        double sum = 0.0, along[2] = {0.0, 0.0};
        for (int k = 0; k < PL_MIDPOINT_AROUND; k++) {
          int x, y;
          pl_midpoint_offset((pl_midpoint_step)step, k, &x, &y);
          sum += at.weights[k];
          along[0] += at.weights[k] * x;
          along[1] += at.weights[k] * y;
          assert_true(fabs(at.weights[k] - at.weights[PL_MIDPOINT_AROUND - 1 - k]) < 1e-6);
        }
        assert_true(fabs(sum - 1.0) < 1e-9 && fabs(along[0]) < 1e-6 && fabs(along[1]) < 1e-6);
        assert_true(isfinite(at.variance) && at.variance >= 0.0);
      }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_variances),
      cmocka_unit_test(test_weights),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
