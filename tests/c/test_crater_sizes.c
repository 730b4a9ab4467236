/* Size-frequency laws of craters against published numbers, and sizes drawn from them. */
#include "harness.h"

#include <math.h>
#include <string.h>

#include "random.h"
#include "terrain/crater_sizes.h"
#include "terrain/size_table.h"

static void near(double value, double expected, double relative) {
  if (!(fabs(value - expected) <= relative * fabs(expected)))
    fail_msg("%.12g, expected %.12g", value, expected);
}

static pl_crater_law law_of(pl_crater_law_kind kind) {
  return (pl_crater_law){.kind = kind, .surface_age_ga = 1.0, .factor = 1.0};
}

/* Densities per km^2 of a surface of 1 Ga: the polynomial of Neukum et al. (2001) with -3.0768. */
static void test_production(void **state) {
  (void)state;
  const double km[] = {0.01, 0.02, 0.05, 0.1,  0.2,  0.5,   1.0,
                       2.0,  5.0,  10.0, 20.0, 50.0, 100.0, 300.0};
  const double n[] = {3796.582136636,    469.5522440089,    26.07383779,       2.904768992688,
                      0.2982645225285,   0.01088539444537,  8.379150674384e-4, 8.883300596469e-5,
                      1.160146570336e-5, 4.604414363156e-6, 1.997592878024e-6, 3.629198668586e-7,
                      5.781056315156e-8, 3.902724224538e-9};
  const pl_crater_law law = law_of(PL_CRATERS_NEUKUM_2001);
  for (int k = 0; k < 14; k++)
    near(1e6 * pl_crater_density(&law, 1e3 * km[k]), n[k], 1e-9);
  /* Below 10 m the power law of 10 m, not the polynomial. */
  near(1e6 * pl_crater_density(&law, 1.0), 3796.582136636 * pow(10.0, 3.1553584), 1e-6);
  near(pl_crater_density(&law, 600e3), pl_crater_density(&law, 300e3) * pow(2.0, -1.8261504), 1e-6);
}

static void test_chronology(void **state) {
  (void)state;
  const double t[] = {0.1, 1.0, 2.0, 3.0, 3.5, 3.8, 4.0, 4.4};
  const double n[] = {8.38000000544e-5, 8.38000055569e-4, 1.67605687482e-3, 2.57215421237e-3,
                      4.79256583401e-3, 0.0180543595159,  0.0628143320885,  0.954524569501};
  for (int k = 0; k < 8; k++) {
    near(1e6 * pl_crater_chronology(t[k]), n[k], 1e-11);
    near(pl_crater_chronology_age_ga(pl_crater_chronology(t[k])), t[k], 1e-12);
  }
  near(pl_crater_chronology_age_ga(pl_crater_chronology(1e-9)), 1e-9, 1e-6);
  assert_true(pl_crater_chronology_age_ga(0.0) == 0.0);
}

static void test_equilibrium(void **state) {
  (void)state;
  pl_crater_law law = law_of(PL_CRATERS_TRASK);
  near(1e6 * pl_crater_density(&law, 10.0), 794.3282347, 1e-9);
  law = law_of(PL_CRATERS_HARTMANN_1984);
  near(1e6 * pl_crater_density(&law, 1000.0), pow(10.0, -1.14), 1e-12);
  law = law_of(PL_CRATERS_VIPER);
  near(1e6 * pl_crater_density(&law, 10.0), 350.7, 1e-3);
  near(1e6 * pl_crater_density(&law, 80.0), 6.47, 1e-3);
  near(1e6 * pl_crater_density(&law, 80.0001), 4.44, 1e-3);
}

/* Where production reaches equilibrium: 42.28 m in 1 Ga, 110.2 m in 3 Ga, 419.9 m in 3.8 Ga. */
static void test_crossover(void **state) {
  (void)state;
  const double ages[] = {0.5, 1.0, 2.0, 3.0, 3.5, 3.8};
  const double at[] = {23.32, 42.28, 76.53, 110.2, 179.3, 419.9};
  pl_crater_law law = law_of(PL_CRATERS_NEUKUM_EQUILIBRIUM), part = law;
  for (int k = 0; k < 6; k++) {
    law.surface_age_ga = part.surface_age_ga = ages[k];
    part.kind = PL_CRATERS_TRASK;
    near(pl_crater_density(&law, 0.99 * at[k]), pl_crater_density(&part, 0.99 * at[k]), 1e-12);
    part.kind = PL_CRATERS_NEUKUM_2001;
    near(pl_crater_density(&law, 1.01 * at[k]), pl_crater_density(&part, 1.01 * at[k]), 1e-12);
    /* Larger craters are as old as the surface, smaller ones as production needs. */
    assert_true(pl_crater_oldest_ga(&law, 1.01 * at[k]) > ages[k] * (1.0 - 1e-12));
    assert_true(pl_crater_oldest_ga(&law, 0.98 * at[k]) < ages[k]);
    assert_true(pl_crater_oldest_ga(&law, 1.0) < 0.02);
  }
}

static pl_size_table *table_of(const pl_crater_law *law, double min_m, double max_m) {
  pl_size_table *table;
  assert_int_equal(pl_crater_law_check(law, min_m, max_m), PL_OK);
  assert_int_equal(pl_size_table_create(pl_crater_density, law, min_m, max_m, &table), PL_OK);
  return table;
}

static const double user_diameters[] = {0.5, 2.0, 30.0, 4000.0};
static const double user_densities[] = {0.2, 0.02, 1e-4, 0.0};

static pl_crater_law law_for_draws(int kind) {
  pl_crater_law law = law_of((pl_crater_law_kind)kind);
  law.surface_age_ga = 3.5;
  law.coefficient = 1.54;
  law.exponent = -2.0;
  law.table.diameters_m = user_diameters;
  law.table.densities = user_densities;
  law.table.count = 4;
  return law;
}

/* Chi-square over 24 bins of equal expectation, with one draw a bin's tenth; 23 degrees of
 * freedom: above 62 in 2e-5 of all seeds. */
static void test_draws(void **state) {
  (void)state;
  enum { BINS = 24 };
  test_random random = {.seed = 19};
  const int draws = PL_DRAWS(100000, 5000);
  for (int kind = 0; kind < PL_CRATER_LAWS; kind++) {
    const pl_crater_law law = law_for_draws(kind);
    const double low = 3.0, high = 2000.0;
    pl_size_table *table = table_of(&law, 1.0, 4000.0);
    const double most = pl_crater_density(&law, low), least = pl_crater_density(&law, high);
    int counts[BINS] = {0};
    for (int k = 0; k < draws; k++) {
      const double d = pl_size_table_draw(table, low, high, random_unit(&random));
      assert_true(d >= low && d <= high);
      /* The jump of viper is spread over 2 % of diameter: count it as one side. */
      const double seen = kind == PL_CRATERS_VIPER && d > 78.0 && d < 82.0 ? 80.0 : d;
      const int bin = (int)((most - pl_crater_density(&law, seen)) / (most - least) * BINS);
      counts[bin < BINS ? bin : BINS - 1]++;
    }
    double square = 0.0;
    for (int bin = 0; bin < BINS; bin++)
      square += pow(counts[bin] - draws / (double)BINS, 2.0) / (draws / (double)BINS);
    if (!(square < 62.0))
      fail_msg("%s: chi-square %g", pl_crater_laws[kind].name, square);
    pl_size_table_destroy(table);
  }
}

static void test_table(void **state) {
  (void)state;
  const pl_crater_law law = law_of(PL_CRATERS_NEUKUM_2001);
  pl_size_table *table = table_of(&law, 0.01, 300e3);
  for (double d = 0.0125; d < 270e3; d *= 1.07) {
    near(pl_size_table_density(table, d), pl_crater_density(&law, d), 1e-4);
    const double low = 0.9 * d, high = 1.1 * d;
    const double n = pl_crater_density(&law, low), m = pl_crater_density(&law, high);
    near(pl_size_table_draw(table, low, high, (n - pl_crater_density(&law, d)) / (n - m)), d, 1e-4);
    near(pl_size_table_draw(table, low, high, 0.0), low, 1e-4);
  }
  near(pl_size_table_density(table, 1e-9), pl_crater_density(&law, 0.01), 1e-12);
  pl_size_table_destroy(table);
}

/* A law that is given by points: these themselves, and power laws between them. */
static void test_points(void **state) {
  (void)state;
  static const double diameters[] = {1.0, 10.0, 100.0, 200.0},
                      densities[] = {1e-2, 1e-4, 1e-7, 0.0};
  const pl_size_points points = {diameters, densities, 4};
  for (size_t k = 0; k < 4; k++)
    near(pl_size_points_density(&points, diameters[k]), densities[k], 1e-12);
  near(pl_size_points_density(&points, sqrt(10.0)), 1e-3, 1e-12);
  near(pl_size_points_density(&points, sqrt(1000.0)), pow(10.0, -5.5), 1e-12);
  assert_true(pl_size_points_density(&points, 150.0) < 1e-7);
}

static void test_no_craters(void **state) {
  (void)state;
  pl_crater_law law = law_of(PL_CRATERS_TRASK);
  law.factor = 0.0;
  pl_size_table *table = table_of(&law, 1.0, 100.0);
  assert_true(pl_size_table_density(table, 1.0) == 0.0);
  const double d = pl_size_table_draw(table, 2.0, 4.0, 0.5);
  assert_true(d >= 2.0 && d <= 4.0);
  pl_size_table_destroy(table);
}

static void refuse(pl_crater_law law, const char *word) {
  assert_int_equal(pl_crater_law_check(&law, 1.0, 100.0), PL_E_RANGE);
  if (strstr(pl_error_text(), word) == NULL)
    fail_msg("\"%s\" does not name %s", pl_error_text(), word);
}

static void test_errors(void **state) {
  (void)state;
  pl_crater_law law = law_of(PL_CRATERS_NEUKUM_2001);
  law.surface_age_ga = 4.6;
  refuse(law, "surface_age_ga");
  law.surface_age_ga = (double)NAN;
  refuse(law, "surface_age_ga");
  law = law_of(PL_CRATERS_TRASK);
  law.factor = -1.0;
  refuse(law, "factor");
  law = law_of(PL_CRATERS_POWER);
  law.coefficient = 1.0, law.exponent = 0.5;
  refuse(law, "exponent");
  law = law_for_draws(PL_CRATERS_TABLE);
  law.table.count = 1;
  refuse(law, "2 entries");
  const double rising[] = {0.2, 0.3, 1e-4, 0.0};
  law.table.count = 4, law.table.densities = rising;
  refuse(law, "entry 1");
  law = law_for_draws(PL_CRATERS_TABLE);
  assert_int_equal(pl_crater_law_check(&law, 0.1, 100.0), PL_E_RANGE);
  pl_size_table *table;
  law = law_of(PL_CRATERS_TRASK);
  assert_int_equal(pl_size_table_create(pl_crater_density, &law, 5.0, 5.0, &table), PL_E_RANGE);
  law.kind = PL_CRATER_LAWS;
  assert_int_equal(pl_crater_law_check(&law, 1.0, 100.0), PL_E_ARGUMENT);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_production),  cmocka_unit_test(test_chronology),
      cmocka_unit_test(test_equilibrium), cmocka_unit_test(test_crossover),
      cmocka_unit_test(test_draws),       cmocka_unit_test(test_table),
      cmocka_unit_test(test_points),      cmocka_unit_test(test_no_craters),
      cmocka_unit_test(test_errors),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
