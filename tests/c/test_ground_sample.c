/* Samples of ground: shares and sizes of clods by their law, kinds of ground, what is refused. */
#include "harness.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "terrain/ground_sample.h"

enum { SIDE = 512 };

static const pl_clods surveyor = {.seed = 3,
                                  .pixels = SIDE,
                                  .size_m = 4.0,
                                  .min_m = 0.02,
                                  .max_m = 0.2,
                                  .density = 150.0,
                                  .exponent = 2.11};

/* Fraction of pixels that clods are higher than 0 on. */
static double fraction_of(pl_clods of, float *heights, float *highest) {
  size_t count = 0;
  *highest = 0.0f;
  assert_int_equal(pl_clods_make(&of, heights), PL_OK);
  for (size_t k = 0; k < SIDE * SIDE; k++) {
    assert_true(heights[k] >= 0.0f);
    *highest = fmaxf(*highest, heights[k]);
    count += heights[k] > 0.0f;
  }
  return (double)count / (SIDE * SIDE);
}

static float *sample(void) {
  float *out = pl_alloc((size_t)SIDE * SIDE, sizeof *out);
  assert_non_null(out);
  return out;
}

/* Numbers by the law: the fractions of two ranges of sizes are as those of their outlines, and so
 * are those of densities. Outlines are narrower than circles, but touch more pixels. */
static void test_law(void **state) {
  (void)state;
  float *heights = sample(), highest;
  pl_clods small = surveyor, large = surveyor, twice = surveyor;
  small.max_m = large.min_m = 0.06;
  twice.density *= 0.5;
  const double all = fraction_of(surveyor, heights, &highest) / pl_clods_cover(&surveyor);
  assert_true(highest > 0.02f && highest < 0.11f);
  assert_true(all > 0.85 && all < 1.15);
  const double each[3] = {fraction_of(small, heights, &highest) / pl_clods_cover(&small),
                          fraction_of(large, heights, &highest) / pl_clods_cover(&large),
                          fraction_of(twice, heights, &highest) / pl_clods_cover(&twice)};
  /* Of clods near the pixel's width more pixels are touched; 170 large ones scatter by a tenth. */
  assert_true(each[0] / all > 0.85 && each[0] / all < 1.3);
  assert_true(each[1] / all > 0.7 && each[1] / all < 1.15);
  assert_true(each[2] / all > 0.85 && each[2] / all < 1.25);
  pl_free(heights);
}

static void test_seeds(void **state) {
  (void)state;
  float *a = sample(), *b = sample();
  pl_clods other = surveyor;
  assert_int_equal(pl_clods_make(&surveyor, a), PL_OK);
  assert_int_equal(pl_clods_make(&surveyor, b), PL_OK);
  assert_memory_equal(a, b, (size_t)SIDE * SIDE * sizeof *a);
  other.seed = UINT64_MAX;
  assert_int_equal(pl_clods_make(&other, b), PL_OK);
  assert_true(memcmp(a, b, (size_t)SIDE * SIDE * sizeof *a) != 0);
  pl_free(a);
  pl_free(b);
}

/* The mean is 0, two kinds differ by 1, and the bright one has its fraction. */
static void test_mottling(void **state) {
  (void)state;
  float *fractions = sample();
  pl_mottling of = {.seed = 1, .pixels = SIDE, .cover = 0.3, .border = 0.05, .hurst = 0.7};
  assert_int_equal(pl_mottling_make(&of, fractions), PL_OK);
  double sum = 0.0, low = 1.0, high = -1.0;
  size_t bright = 0;
  for (size_t k = 0; k < SIDE * SIDE; k++) {
    sum += (double)fractions[k];
    low = fmin(low, (double)fractions[k]);
    high = fmax(high, (double)fractions[k]);
  }
  for (size_t k = 0; k < SIDE * SIDE; k++)
    bright += (double)fractions[k] > 0.5 * (low + high);
  assert_true(fabs(sum) < 0.1 && fabs(high - low - 1.0) < 1e-6);
  assert_true(fabs((double)bright / (SIDE * SIDE) - 0.3) < 0.01);
  pl_free(fractions);
}

static void test_refused(void **state) {
  (void)state;
  float *out = sample();
  pl_clods clods[5] = {surveyor, surveyor, surveyor, surveyor, surveyor};
  clods[0].pixels = 8;
  clods[1].max_m = 0.6;
  clods[2].min_m = 0.3;
  clods[3].density = 1e5;
  clods[4].exponent = NAN;
  for (int k = 0; k < 5; k++)
    assert_int_equal(pl_clods_make(&clods[k], out), PL_E_RANGE);
  pl_mottling mottling = {.pixels = SIDE, .cover = 1.0, .border = 1.0, .hurst = 0.5};
  assert_int_equal(pl_mottling_make(&mottling, out), PL_E_RANGE);
  mottling.cover = 0.5;
  mottling.border = INFINITY;
  assert_int_equal(pl_mottling_make(&mottling, out), PL_E_RANGE);
  pl_clods none = surveyor;
  none.density = 0.0;
  assert_int_equal(pl_clods_make(&none, out), PL_OK);
  assert_true(out[0] == 0.0f && out[SIDE * SIDE - 1] == 0.0f);
  pl_free(out);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_law),
      cmocka_unit_test(test_seeds),
      cmocka_unit_test(test_mottling),
      cmocka_unit_test(test_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
