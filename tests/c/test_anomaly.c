/* Times since periapsis of true and mean anomalies: Barker's equation, apoapsis, round trips. */
#include "harness.h"

#include <string.h>

#include "orbit/anomaly.h"

static double since_true(double e, double nu) {
  pl_elements el = {.periapsis_m = 1.0, .eccentricity = e};
  assert_int_equal(pl_elements_set_true_anomaly(&el, 1.0, nu), PL_OK);
  return el.since_periapsis_s;
}

/* nu -> t -> nu over all conics; near the asymptote and near apoapsis nu does not hold t. */
static void test_round_trip(void **state) {
  (void)state;
  static const double es[] = {0.0,         1e-13,       0.3, 0.9,         1.0 - 1e-6,
                              1.0 - 1e-12, 1.0 - 1e-15, 1.0, 1.0 + 1e-15, 1.0 + 1e-12,
                              1.0 + 1e-6,  1.5,         50.0};
  for (size_t i = 0; i < sizeof es / sizeof es[0]; i++) {
    const double e = es[i], limit = e < 1.0 ? PL_PI : acos(-1.0 / e);
    for (double part = -0.95; part <= 0.95; part += 0.05) {
      const double nu = part * limit, t = since_true(e, nu);
      const pl_elements el = {.periapsis_m = 1.0, .eccentricity = e, .since_periapsis_s = t};
      pl_orbit orbit;
      pl_perifocal at;
      assert_int_equal(pl_orbit_from_elements(&el, 1.0, &orbit), PL_OK);
      assert_int_equal(pl_orbit_perifocal(&orbit, 0.0, &at), PL_OK);
      if (!(fabs(atan2(at.y_m, at.x_m) - nu) <= 1e-13))
        fail_msg("e %.17g, nu %.17g: %.17g", e, nu, atan2(at.y_m, at.x_m));
    }
    assert_true(since_true(e, 0.0) == 0.0);
    assert_true(fabs(since_true(e, 1e-12 + 2.0 * PL_PI) - since_true(e, 1e-12)) < 1e-15);
  }
}

/* Apoapsis is half a period away, whatever the eccentricity. */
static void test_apoapsis(void **state) {
  (void)state;
  for (double e = 0.0; e < 0.999; e += 0.037) {
    const double a = 1.0 / (1.0 - e), half = PL_PI * a * sqrt(a);
    assert_true(fabs(fabs(since_true(e, PL_PI)) / half - 1.0) < 1e-14);
    pl_elements el = {.periapsis_m = 1.0, .eccentricity = e};
    assert_int_equal(pl_elements_set_mean_anomaly(&el, 1.0, PL_PI), PL_OK);
    assert_true(fabs(fabs(el.since_periapsis_s) / half - 1.0) < 1e-14);
  }
}

/* Barker: t = sqrt(2) (D + D^3/3) for q = gm = 1. */
static void test_parabola(void **state) {
  (void)state;
  for (double nu = -3.0; nu <= 3.0; nu += 0.1) {
    const double d = tan(0.5 * nu), t = sqrt(2.0) * (d + d * d * d / 3.0);
    assert_true(fabs(since_true(1.0, nu) - t) <= 1e-15 * 8 * fabs(t));
  }
}

/* A million turns of mean anomaly and its rest are one time; hyperbolas keep theirs. */
static void test_mean(void **state) {
  (void)state;
  pl_elements el = {.periapsis_m = 7e6, .eccentricity = 0.1};
  assert_int_equal(pl_elements_set_mean_anomaly(&el, 4e14, 2.0 * PL_PI * 1e6 + 0.5), PL_OK);
  const double many = el.since_periapsis_s;
  assert_int_equal(pl_elements_set_mean_anomaly(&el, 4e14, 0.5), PL_OK);
  assert_true(fabs(many - el.since_periapsis_s) < 1e-9 * el.since_periapsis_s * 10);
  el.eccentricity = 2.0;
  assert_int_equal(pl_elements_set_mean_anomaly(&el, 4e14, -100.0), PL_OK);
  const double n = sqrt(4e14 / (7e6 * 7e6 * 7e6));
  assert_true(fabs(el.since_periapsis_s + 100.0 / n) < 1e-12 / n * 100.0);
}

static void test_errors(void **state) {
  (void)state;
  pl_elements el = {.periapsis_m = 7e6, .eccentricity = 1.0};
  assert_int_equal(pl_elements_set_mean_anomaly(&el, 4e14, 0.1), PL_E_RANGE);
  assert_int_equal(pl_elements_set_true_anomaly(&el, 4e14, PL_PI), PL_E_RANGE);
  el.eccentricity = 2.0;
  assert_int_equal(pl_elements_set_true_anomaly(&el, 4e14, 121.0 * PL_PI / 180.0), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "121 deg is beyond the asymptote: eccentricity 2 has "
                                          "those between -120 and 120 deg"));
  assert_int_equal(pl_elements_set_true_anomaly(&el, 4e14, NAN), PL_E_RANGE);
  assert_int_equal(pl_elements_set_mean_anomaly(&el, 4e14, INFINITY), PL_E_RANGE);
  el.periapsis_m = 0.0;
  assert_int_equal(pl_elements_set_true_anomaly(&el, 4e14, 0.0), PL_E_RANGE);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_round_trip), cmocka_unit_test(test_apoapsis),
      cmocka_unit_test(test_parabola),   cmocka_unit_test(test_mean),
      cmocka_unit_test(test_errors),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
