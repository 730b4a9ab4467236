/* The scrambled Sobol samples: nets, independence of pairs and of pixels. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include <math.h>

#include "math/sampler.h"

/* Any aligned run of 2^k samples has one point in each of the 2^k cells of every dyadic shape. */
static void test_net(void **state) {
  (void)state;
  for (unsigned k = 0; k <= 10; k++)
    for (uint32_t seed = 1; seed <= 5; seed++)
      for (uint32_t block = 0; block < 3; block++)
        for (unsigned kx = 0; kx <= k; kx++) {
          static unsigned char hits[1024];
          memset(hits, 0, sizeof hits);
          for (uint32_t i = 0; i < 1u << k; i++) {
            float p[2];
            pl_sample_2d((block << k) + i, seed * 7919u, seed + block, p);
            const unsigned x = (unsigned)(p[0] * (float)(1u << kx));
            const unsigned y = (unsigned)(p[1] * (float)(1u << (k - kx)));
            assert_int_equal(hits[(y << kx) | x]++, 0);
          }
        }
}

static void test_range_and_determinism(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 200000; i++) {
    float p[2], q[2];
    pl_sample_2d(i * 2654435761u, i, i >> 3, p);
    pl_sample_2d(i * 2654435761u, i, i >> 3, q);
    assert_true(p[0] >= 0.0f && p[0] < 1.0f && p[1] >= 0.0f && p[1] < 1.0f);
    assert_true(p[0] == q[0] && p[1] == q[1]);
  }
}

/* Chi-square of one sample index over 64k consecutive pixel seeds on a 16x16 grid. 255 degrees of
 * freedom: 370 is passed by chance once in 3e6; the seeds are fixed, so it does not flicker. */
static double chi_square_over_seeds(uint32_t index, uint32_t dimension) {
  static int count[256];
  memset(count, 0, sizeof count);
  for (uint32_t seed = 0; seed < 65536; seed++) {
    float p[2];
    pl_sample_2d(index, seed, dimension, p);
    count[(int)(p[0] * 16.0f) * 16 + (int)(p[1] * 16.0f)]++;
  }
  double chi2 = 0.0;
  for (int i = 0; i < 256; i++)
    chi2 += (count[i] - 256.0) * (count[i] - 256.0) / 256.0;
  return chi2;
}

static void test_uniform_over_pixels(void **state) {
  (void)state;
  for (uint32_t index = 0; index < 8; index++)
    for (uint32_t dimension = 0; dimension < 8; dimension++)
      assert_true(chi_square_over_seeds(index, dimension) < 370.0);
}

/* Two dimension pairs of a pixel, and two pixels, are uncorrelated: |correlation| of n = 2^16
 * points below 5 sigma. */
static double correlation(uint32_t seed_a, uint32_t dim_a, uint32_t seed_b, uint32_t dim_b) {
  double sum = 0.0;
  for (uint32_t i = 0; i < 65536; i++) {
    float a[2], b[2];
    pl_sample_2d(i, seed_a, dim_a, a);
    pl_sample_2d(i, seed_b, dim_b, b);
    sum += ((double)a[0] - 0.5) * ((double)b[0] - 0.5);
  }
  return 12.0 * sum / 65536.0;
}

static void test_independence(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 20; i++) {
    assert_true(fabs(correlation(i, 0, i, i + 1)) < 5.0 / 256.0);
    assert_true(fabs(correlation(i, 3, i + 1, 3)) < 5.0 / 256.0);
  }
}

/* Randomised quasi-Monte Carlo pays: x y over 256 points, root mean square error over 100 pixels,
 * at least 20 times below that of independent samples. */
static void test_integration_error(void **state) {
  (void)state;
  double square = 0.0;
  for (uint32_t seed = 0; seed < 100; seed++) {
    double sum = 0.0;
    for (uint32_t i = 0; i < 256; i++) {
      float p[2];
      pl_sample_2d(i, seed, 2, p);
      sum += (double)p[0] * (double)p[1];
    }
    square += pow(sum / 256.0 - 0.25, 2.0);
  }
  const double independent = sqrt((1.0 / 9.0 - 1.0 / 16.0) / 256.0);
  assert_true(sqrt(square / 100.0) < independent / 20.0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_net),
      cmocka_unit_test(test_range_and_determinism),
      cmocka_unit_test(test_uniform_over_pixels),
      cmocka_unit_test(test_independence),
      cmocka_unit_test(test_integration_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
