/* Size-frequency laws of rocks against published numbers, and sizes drawn from them. */
#include "harness.h"

#include <math.h>
#include <string.h>

#include "random.h"
#include "terrain/rock_sizes.h"
#include "terrain/size_table.h"

static void near(double value, double expected, double relative) {
  if (!(fabs(value - expected) <= relative * fabs(expected)))
    fail_msg("%.12g, expected %.12g", value, expected);
}

static pl_rock_law golombek(double k, double q) {
  return (pl_rock_law){.kind = PL_ROCKS_GOLOMBEK, .factor = 1.0, .abundance = k, .decay_per_m = q};
}

/* Densities by SciPy's exp1 in 30 digits, of D = 0.05, 0.1, 0.5 and 1 m. */
static void test_golombek(void **state) {
  (void)state;
  const double d[] = {0.05, 0.1, 0.5, 1.0};
  const double k[] = {0.01, 0.05, 0.1, 0.2}, q[] = {16.99, 4.83, 3.31, 2.55};
  const double n[4][4] = {{0.8053314579, 0.1208065309, 8.565214871e-6, 4.787712452e-10},
                          {3.23919896, 1.034197839, 0.01355339395, 3.72843367e-4},
                          {5.217479919, 1.863513862, 0.04993377838, 3.074629273e-3},
                          {8.773163788, 3.328237199, 0.1297383722, 0.01207279494}};
  for (int a = 0; a < 4; a++)
    for (int b = 0; b < 4; b++) {
      const pl_rock_law given = golombek(k[a], q[a]), fitted = golombek(k[a], 0.0);
      near(pl_rock_density(&given, d[b]), n[a][b], 1e-9);
      near(pl_rock_density(&fitted, d[b]), n[a][b], 1e-9);
    }
  const double change_3[] = {0.4143098395, 0.1683997048, 9.987019036e-3, 1.460759252e-3};
  const pl_rock_law law = {.kind = PL_ROCKS_CHANGE_3, .factor = 1.0};
  for (int b = 0; b < 4; b++)
    near(pl_rock_density(&law, d[b]), change_3[b], 1e-9);
}

/* Beyond q D = 50 the two terms agree to all digits of a double: N is their asymptotic series. */
static void test_gamma(void **state) {
  (void)state;
  for (double x = 200.0; x < 600.0; x *= 1.5)
    near(pl_rock_gamma(x), exp(-x) / (x * x) * (1.0 - 2.0 / x + 6.0 / (x * x)), 30.0 / (x * x * x));
  /* From mpmath 1.3; both branches meet at 2. */
  near(pl_rock_gamma(0.5), 0.653287724649106, 1e-12);
  near(pl_rock_gamma(1.0), 0.148495506775922, 1e-12);
  near(pl_rock_gamma(nextafter(2.0, 0.0)), pl_rock_gamma(2.0), 1e-13);
  near(pl_rock_gamma(10.0), 3.83024046563e-7, 1e-9);
  /* The derivative of Gamma(-1, x) is -exp(-x) / x^2. */
  for (double x = 0.01; x < 100.0; x *= 1.3) {
    const double h = 1e-4 * x;
    near((pl_rock_gamma(x - h) - pl_rock_gamma(x + h)) / (2.0 * h), exp(-x) / (x * x), 1e-4);
  }
}

static void test_power(void **state) {
  (void)state;
  const pl_rock_law_kind kinds[] = {PL_ROCKS_SURVEYOR_1, PL_ROCKS_VIPER, PL_ROCKS_INTERCRATER,
                                    PL_ROCKS_HAWORTH};
  const double n1[] = {0.00234, 3.0e-4, 1.0e-4, 2.0e-3};
  const double exponent[] = {-2.11, -2.482, -1.75457, -2.6607};
  for (int k = 0; k < 4; k++) {
    pl_rock_law law = {.kind = kinds[k], .factor = 3.0};
    near(pl_rock_density(&law, 1.0), 3.0 * n1[k], 1e-12);
    near(pl_rock_density(&law, 0.1), 3.0 * n1[k] * pow(0.1, exponent[k]), 1e-12);
    law.cutoff_m = 2.0;
    near(pl_rock_density(&law, 4.0), 3.0 * n1[k] * pow(4.0, exponent[k]) * exp(-2.0), 1e-12);
  }
}

/* F(D) = k exp(-q D) by definition. */
static void test_cover(void **state) {
  (void)state;
  const pl_rock_law law = golombek(0.05, 2.0);
  near(pl_rock_cover(&law, 0.05, 20.0), 0.05 * (exp(-0.1) - exp(-40.0)), 1e-3);
  near(pl_rock_cover(&law, 0.5, 1.0), 0.05 * (exp(-1.0) - exp(-2.0)), 1e-3);
}

static const double diameters[] = {0.05, 0.5, 30.0}, densities[] = {2.0, 0.01, 0.0};
static pl_rock_law law_for_draws(int kind) {
  pl_rock_law law = golombek(0.05, 0.0);
  law.kind = (pl_rock_law_kind)kind;
  law.coefficient = 0.01;
  law.exponent = -2.2;
  law.table = (pl_size_points){diameters, densities, 3};
  return law;
}

/* Chi-square over 24 bins of equal expectation, 23 degrees of freedom: above 62 in 2e-5 of all
 * seeds. */
static void test_draws(void **state) {
  (void)state;
  enum { BINS = 24 };
  test_random random = {.seed = 19};
  const int draws = PL_DRAWS(100000, 5000);
  for (int kind = 0; kind < PL_ROCK_LAWS; kind++) {
    const pl_rock_law law = law_for_draws(kind);
    pl_size_table *table;
    assert_int_equal(pl_rock_law_check(&law, 0.05, 30.0), PL_OK);
    assert_int_equal(pl_size_table_create(pl_rock_density, &law, 0.05, 30.0, &table), PL_OK);
    const double low = 0.1, high = 6.0;
    const double most = pl_rock_density(&law, low), least = pl_rock_density(&law, high);
    int counts[BINS] = {0};
    for (int k = 0; k < draws; k++) {
      const double d = pl_size_table_draw(table, low, high, random_unit(&random));
      const int bin = (int)((most - pl_rock_density(&law, d)) / (most - least) * BINS);
      counts[bin < 0 ? 0 : bin < BINS ? bin : BINS - 1]++;
    }
    double square = 0.0;
    for (int bin = 0; bin < BINS; bin++)
      square += pow(counts[bin] - draws / (double)BINS, 2.0) / (draws / (double)BINS);
    if (!(square < 62.0))
      fail_msg("%s: chi-square %g", pl_rock_laws[kind].name, square);
    pl_size_table_destroy(table);
  }
}

static void refuse(pl_rock_law law, const char *word) {
  assert_int_equal(pl_rock_law_check(&law, 0.1, 10.0), PL_E_RANGE);
  if (strstr(pl_error_text(), word) == NULL)
    fail_msg("\"%s\" does not name %s", pl_error_text(), word);
}

static void test_errors(void **state) {
  (void)state;
  refuse(golombek(0.003, 0.0), "decay_per_m");
  const pl_rock_law lunar = golombek(0.003, 1.8);
  assert_int_equal(pl_rock_law_check(&lunar, 0.1, 10.0), PL_OK);
  refuse(golombek(0.0, 1.0), "abundance");
  refuse(golombek((double)NAN, 1.0), "abundance");
  refuse(golombek(0.1, -1.0), "decay_per_m");
  pl_rock_law law = {.kind = PL_ROCKS_VIPER, .factor = -1.0};
  refuse(law, "factor");
  law.factor = 1.0, law.cutoff_m = (double)INFINITY;
  refuse(law, "cutoff_m");
  law = (pl_rock_law){.kind = PL_ROCKS_POWER, .factor = 1.0, .coefficient = 1.0, .exponent = 1.0};
  refuse(law, "exponent");
  law = law_for_draws(PL_ROCKS_TABLE);
  law.table.count = 1;
  refuse(law, "2 entries");
  law = law_for_draws(PL_ROCKS_TABLE);
  assert_int_equal(pl_rock_law_check(&law, 0.01, 10.0), PL_E_RANGE);
  law.kind = PL_ROCK_LAWS;
  assert_int_equal(pl_rock_law_check(&law, 0.1, 10.0), PL_E_ARGUMENT);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_golombek), cmocka_unit_test(test_gamma), cmocka_unit_test(test_power),
      cmocka_unit_test(test_cover),    cmocka_unit_test(test_draws), cmocka_unit_test(test_errors),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
