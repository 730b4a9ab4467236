/* The random numbers of the sensor: against the distributions' own formulas. */
#include "harness.h"

#include <math.h>

#include "sensor/draws.h"

enum { COUNT = 200000, CELLS = 64 };

/* Chi-square of drawn counts against the probabilities exp(k log m - m - lgamma(k + 1)), cells of
 * fewer than 20 expected counts merged. A false alarm once in 1e5: 5 sigma of its normal limit. */
static void check_pmf(double mean, uint64_t seed) {
  const double low = floor(mean - CELLS / 2.0 * sqrt(mean) / 6.0), start = fmax(0.0, low);
  const double step = fmax(1.0, floor(sqrt(mean) / 5.0));
  double expected[CELLS] = {0}, found[CELLS] = {0}, chi = 0.0, pooled[2] = {0};
  int cells = 0;
  for (double k = start; k < start + step * CELLS; k++)
    expected[(int)((k - start) / step)] += COUNT * exp(k * log(mean) - mean - lgamma(k + 1.0));
  for (uint64_t i = 0; i < COUNT; i++) {
    pl_stream stream = pl_stream_of(seed, PL_DRAW_SHOT, i, 0);
    const double cell = floor((pl_stream_poisson(&stream, mean) - start) / step);
    if (cell >= 0.0 && cell < CELLS)
      found[(int)cell] += 1.0;
  }
  for (int i = 0; i < CELLS; i++) {
    if (expected[i] < 20.0) {
      pooled[0] += expected[i];
      pooled[1] += found[i];
      continue;
    }
    chi += pow(found[i] - expected[i], 2.0) / expected[i];
    cells++;
  }
  assert_true(cells >= 3);
  assert_true(chi < cells + 5.0 * sqrt(2.0 * cells) + 5.0);
  assert_true(fabs(pooled[1] - pooled[0]) < 5.0 * sqrt(pooled[0]) + 5.0);
}

static void poisson_has_its_probabilities(void **state) {
  (void)state;
  const double means[] = {0.5, 3.0, 9.99, 10.0, 11.5, 40.0, 300.0, 9999.0};
  for (size_t i = 0; i < sizeof means / sizeof means[0]; i++)
    check_pmf(means[i], 100 + i);
}

/* Mean and variance within 5 standard errors, on both sides of each switch of methods. */
static void poisson_has_its_moments(void **state) {
  (void)state;
  const double means[] = {1e-3, 9.999, 10.001, 9999.0, 10001.0, 1e6, 1e12};
  for (size_t k = 0; k < sizeof means / sizeof means[0]; k++) {
    double sum = 0.0, squares = 0.0;
    for (uint64_t i = 0; i < COUNT; i++) {
      pl_stream stream = pl_stream_of(9, PL_DRAW_SHOT, i, k);
      const double d = pl_stream_poisson(&stream, means[k]) - means[k];
      sum += d;
      squares += d * d;
    }
    const double m = means[k], error = sqrt(m / COUNT);
    assert_true(fabs(sum / COUNT) < 5.0 * error);
    /* the fourth central moment of Poisson is 3 m^2 + m */
    assert_true(fabs(squares / COUNT - m) < 5.0 * sqrt((2.0 * m * m + m) / COUNT));
  }
}

/* P(N >= k) of pl_poisson_most by summing: below 1e-9, and not by much. */
static void poisson_most_is_rarely_reached(void **state) {
  (void)state;
  for (double mean = 1e-7; mean < 1e5; mean *= 3.0) {
    const double most = pl_poisson_most(mean);
    double tails[2] = {0};
    for (int which = 0; which < 2; which++) {
      const double first = ceil(which == 0 ? most : mean + 0.8 * (most - mean) - 1.0);
      for (double k = fmax(first, 0.0); k < most + 100.0 * sqrt(most) + 100.0; k += 1.0)
        tails[which] += exp(k * log(mean) - mean - lgamma(k + 1.0));
    }
    assert_true(tails[0] <= 1e-9 && tails[1] > 1e-9);
  }
  assert_true(pl_poisson_most(0.0) == 0.0 && pl_poisson_most(NAN) == 0.0);
  assert_true(pl_poisson_most(-1.0) == 0.0 && isinf(pl_poisson_most(INFINITY)));
  assert_true(pl_poisson_most(1e300) >= 1e300 && pl_poisson_most(1e-300) > 0.0);
}

static void poisson_of_nothing_is_nothing(void **state) {
  (void)state;
  const double none[] = {0.0, -1.0, -INFINITY, (double)NAN};
  for (size_t i = 0; i < 4; i++) {
    pl_stream stream = pl_stream_of(1, PL_DRAW_SHOT, i, 0);
    assert_true(pl_stream_poisson(&stream, none[i]) == 0.0);
  }
}

static void normal_has_its_moments(void **state) {
  (void)state;
  double moments[4] = {0};
  for (uint64_t i = 0; i < COUNT; i++) {
    pl_stream stream = pl_stream_of(5, PL_DRAW_READ, i, 1);
    const double x = pl_stream_normal(&stream);
    for (int k = 0; k < 4; k++)
      moments[k] += pow(x, k + 1) / COUNT;
  }
  const double errors[] = {1.0, sqrt(2.0), sqrt(15.0), sqrt(96.0)}, exact[] = {0.0, 1.0, 0.0, 3.0};
  for (int k = 0; k < 4; k++)
    assert_true(fabs(moments[k] - exact[k]) < 5.0 * errors[k] / sqrt(COUNT));
}

static void keys_part_the_streams(void **state) {
  (void)state;
  pl_stream a = pl_stream_of(1, PL_DRAW_READ, 2, 3), b = pl_stream_of(1, PL_DRAW_READ, 2, 3);
  const double first = pl_stream_uniform(&a);
  assert_true(first == pl_stream_uniform(&b));
  assert_true(pl_stream_uniform(&a) != first);
  pl_stream others[] = {pl_stream_of(2, PL_DRAW_READ, 2, 3), pl_stream_of(1, PL_DRAW_SHOT, 2, 3),
                        pl_stream_of(1, PL_DRAW_READ, 3, 3), pl_stream_of(1, PL_DRAW_READ, 2, 4)};
  for (size_t i = 0; i < 4; i++)
    assert_true(pl_stream_uniform(&others[i]) != first);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(poisson_has_its_probabilities),
      cmocka_unit_test(poisson_has_its_moments),
      cmocka_unit_test(poisson_of_nothing_is_nothing),
      cmocka_unit_test(poisson_most_is_rarely_reached),
      cmocka_unit_test(normal_has_its_moments),
      cmocka_unit_test(keys_part_the_streams),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
