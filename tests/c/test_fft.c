/* The Fourier transform against its definition, and there and back. */
#include "harness.h"

#include <math.h>

#include "math/fft.h"

enum { MOST = 1024 };

static void fill(pl_complex *data, size_t n) {
  for (size_t i = 0; i < n; i++)
    data[i] = (pl_complex){sin(1.0 + 0.7 * (double)(i * i)), cos(3.0 * (double)i)};
}

static void transforms_are_their_sums(void **state) {
  (void)state;
  for (size_t n = 1; n <= 64; n *= 2) {
    pl_complex data[64], given[64], scratch[64], factors[32];
    fill(given, n);
    fill(data, n);
    pl_fft_factors(n, factors);
    pl_fft(data, scratch, n, factors, false);
    for (size_t k = 0; k < n; k++) {
      double re = 0.0, im = 0.0;
      for (size_t j = 0; j < n; j++) {
        const double angle = -2.0 * acos(-1.0) * (double)(j * k % n) / (double)n;
        re += given[j].re * cos(angle) - given[j].im * sin(angle);
        im += given[j].re * sin(angle) + given[j].im * cos(angle);
      }
      assert_true(hypot(data[k].re - re, data[k].im - im) < 1e-13 * (double)n);
    }
  }
}

static void back_is_where_it_came_from(void **state) {
  (void)state;
  static pl_complex data[MOST], given[MOST], scratch[MOST], factors[MOST / 2];
  for (size_t n = 1; n <= MOST; n *= 2) {
    fill(given, n);
    fill(data, n);
    pl_fft_factors(n, factors);
    pl_fft(data, scratch, n, factors, false);
    pl_fft(data, scratch, n, factors, true);
    for (size_t k = 0; k < n; k++)
      assert_true(hypot(data[k].re - given[k].re, data[k].im - given[k].im) < 1e-14);
  }
}

static void sizes_are_powers_of_two(void **state) {
  (void)state;
  const size_t rows[][2] = {{1, 1}, {2, 2}, {3, 4}, {1000, 1024}, {1024, 1024}, {1025, 2048}};
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
    assert_int_equal(pl_fft_size(rows[i][0]), rows[i][1]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(transforms_are_their_sums),
      cmocka_unit_test(back_is_where_it_came_from),
      cmocka_unit_test(sizes_are_powers_of_two),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
