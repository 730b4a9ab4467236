/* Gauss-Legendre rules against published nodes and the integrals of powers. */
#include "harness.h"

#include <math.h>

#include "math/quadrature.h"

/* Abramowitz and Stegun, table 25.4. */
static void test_published(void **state) {
  (void)state;
  const pl_gauss five = pl_gauss_make(5);
  const double node[] = {0.0, 0.538469310105683, 0.906179845938664};
  const double weight[] = {0.568888888888889, 0.478628670499366, 0.236926885056189};
  for (int i = 0; i < 3; i++) {
    assert_true(fabs(five.node[2 + i] - node[i]) < 1e-15);
    assert_true(fabs(five.node[2 - i] + node[i]) < 1e-15);
    assert_true(fabs(five.weight[2 + i] - weight[i]) < 1e-15);
  }
}

/* Exact for powers up to 2 n - 1: x^k has the integral 2/(k+1), or 0. */
static void test_powers(void **state) {
  (void)state;
  for (int n = 1; n <= PL_GAUSS_MAX; n++) {
    const pl_gauss rule = pl_gauss_make(n);
    assert_int_equal(rule.count, n);
    for (int power = 0; power < 2 * n; power++) {
      double sum = 0.0;
      for (int i = 0; i < n; i++)
        sum += rule.weight[i] * pow(rule.node[i], power);
      assert_true(fabs(sum - (power % 2 ? 0.0 : 2.0 / (power + 1))) < 2e-14);
    }
    for (int i = 0; i + 1 < n; i++)
      assert_true(rule.node[i] < rule.node[i + 1]);
  }
}

static void test_count_is_cut_off(void **state) {
  (void)state;
  assert_int_equal(pl_gauss_make(-3).count, 1);
  assert_int_equal(pl_gauss_make(1000).count, PL_GAUSS_MAX);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_published),
      cmocka_unit_test(test_powers),
      cmocka_unit_test(test_count_is_cut_off),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
