/* Secular rates and mean elements by J2: the science sheet's table, an integration, invariants. */
#include "harness.h"

#include <string.h>

#include "orbit/j2.h"
#include "random.h"

#define GM 398600.4418e9
#define DAY 86400.0
#define DEG (PL_PI / 180.0)
static const pl_flattening EARTH = {1.0826266835531513e-3, 6378137.0};

static pl_elements ellipse(double a, double e, double i, double raan, double arg, double since) {
  return (pl_elements){a * (1.0 - e), e, i, raan, arg, since};
}
static pl_orbit orbit_of(pl_elements el) {
  pl_orbit out;
  assert_int_equal(pl_orbit_from_elements(&el, GM, &out), PL_OK);
  return out;
}
static double distance(pl_vec3 a, pl_vec3 b) { return pl_vec3_norm(pl_vec3_sub(a, b)); }

/* Science sheet 2.2; deg a day. */
static void test_rates(void **state) {
  (void)state;
  static const struct {
    double a_km, e, i_deg, raan, arg, mean;
  } rows[] = {
      {6778.137, 0.001, 51.6, -5.0023323554948, 3.7412845347849, 5601.301063015},
      {7078.137, 0.001, 98.19, 0.98589061580967, -3.1092137926271, 5245.1490057364},
      {26560, 0.74, 63.434948822922, -0.14775238285876, 0.0, 721.99871372602},
      {42164.17, 0.0001, 0.05, -0.013414062768287, 0.026828110213485, 360.99905672041},
  };
  for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
    const pl_elements el = ellipse(rows[k].a_km * 1e3, rows[k].e, rows[k].i_deg * DEG, 0, 0, 0);
    pl_drift drift;
    assert_int_equal(pl_j2_drift(&el, GM, EARTH, &drift), PL_OK);
    assert_true(fabs(drift.raan_rad_s * DAY / DEG / rows[k].raan - 1.0) < 1e-12);
    assert_true(fabs(drift.arg_periapsis_rad_s * DAY / DEG - rows[k].arg) <
                1e-12 + 1e-12 * fabs(rows[k].arg));
    assert_true(fabs(drift.mean_anomaly_rad_s * DAY / DEG / rows[k].mean - 1.0) < 1e-12);
  }
  /* sun-synchronous at 800 km (science sheet 3): 360 deg in 365.242189 days */
  const pl_elements sso = ellipse(7178137.0, 0.0, 98.603110649 * DEG, 0, 0, 0);
  pl_drift drift;
  assert_int_equal(pl_j2_drift(&sso, GM, EARTH, &drift), PL_OK);
  assert_true(fabs(drift.raan_rad_s / 1.991063857259666e-7 - 1.0) < 1e-9);
}

/* The places of an ellipse whose angles are moved by hand; without J2, Kepler's own states. */
static void test_states(void **state) {
  (void)state;
  test_random random = {.seed = 3};
  for (int n = 0; n < 2000; n++) {
    const double e = n % 5 == 0 ? 0.0 : random_range(&random, 0.0, 0.9);
    const double i = n % 7 == 0 ? 0.0 : n % 7 == 1 ? PL_PI : random_range(&random, 0.0, PL_PI);
    const pl_elements el =
        ellipse(random_scale(&random, 6.6e6, 5e7), e, i, random_range(&random, -4, 4),
                random_range(&random, -4, 4), 50.0);
    const pl_quat equator = random_rotation(&random);
    const pl_orbit orbit = orbit_of(el);
    const double t = random_range(&random, -1e6, 1e6);
    pl_drift drift;
    assert_int_equal(pl_j2_drift(&el, GM, EARTH, &drift), PL_OK);
    for (int k = 0; k < 2; k++) {
      const pl_flattening flattening = {k == 0 ? 0.0 : EARTH.j2, EARTH.radius_m};
      pl_propagator *path;
      assert_int_equal(pl_j2_create(&orbit, flattening, false, equator, equator, &path), PL_OK);
      pl_state got, kepler;
      assert_int_equal(pl_propagator_states(path, 1, &t, &got), PL_OK);
      pl_propagator_destroy(path);
      pl_elements moved = el;
      double later = t;
      if (k == 1) {
        moved.raan_rad += drift.raan_rad_s * t;
        moved.arg_periapsis_rad += drift.arg_periapsis_rad_s * t;
        later *= drift.mean_anomaly_rad_s * pl_orbit_period_s(&orbit) / (2.0 * PL_PI);
      }
      const pl_orbit there = orbit_of(moved);
      assert_int_equal(pl_orbit_states(&there, 1, &later, &kepler), PL_OK);
      const double phase = 1e-12 + 1e-15 * fabs(t) * drift.mean_anomaly_rad_s / (1.0 - e);
      const double size = el.periapsis_m / (1.0 - e) * (1.0 + e) / (1.0 - e);
      assert_true(distance(got.r_m, pl_quat_rotate(equator, kepler.r_m)) <= phase * size);
      if (k == 0)
        assert_true(distance(got.v_m_s, pl_quat_rotate(equator, kepler.v_m_s)) <=
                    phase * pl_vec3_norm(kepler.v_m_s) / (1.0 - e));
    }
  }
}

/* Velocities are the derivatives of the places. */
static void test_velocity(void **state) {
  (void)state;
  const pl_orbit orbit = orbit_of(ellipse(7.2e6, 0.05, 1.1, 0.3, 2.0, 10.0));
  pl_propagator *path;
  assert_int_equal(pl_j2_create(&orbit, EARTH, true, PL_QUAT_IDENTITY, PL_QUAT_IDENTITY, &path),
                   PL_OK);
  for (double t = -1e5; t < 1e5; t += 7777.0) {
    const double times[5] = {t - 2.0, t - 1.0, t, t + 1.0, t + 2.0};
    pl_state s[5];
    assert_int_equal(pl_propagator_states(path, 5, times, s), PL_OK);
    const pl_vec3 near = pl_vec3_sub(s[3].r_m, s[1].r_m), far = pl_vec3_sub(s[4].r_m, s[0].r_m);
    const pl_vec3 v = pl_vec3_madd(pl_vec3_scale(near, 8.0 / 12.0), -1.0 / 12.0, far);
    assert_true(distance(v, s[2].v_m_s) < 1e-7); /* the rounding of places of 7e6 m */
  }
  pl_propagator_destroy(path);
}

/* Acceleration by the point mass and J2, pole along z (science sheet 2.1, n = 2). */
static pl_vec3 acceleration(pl_vec3 r) {
  const double d = pl_vec3_norm(r), s = r.z / d, d2 = d * d;
  const double k = 1.5 * GM * EARTH.j2 * EARTH.radius_m * EARTH.radius_m / (d2 * d2);
  const pl_vec3 radial = pl_vec3_scale(r, -GM / (d2 * d) + k * (5.0 * s * s - 1.0) / d);
  return pl_vec3_add(radial, pl_vec3_make(0.0, 0.0, -2.0 * k * s));
}
static void rk4(pl_state *y, double h) {
  pl_state k[4], at = *y;
  for (int i = 0; i < 4; i++) {
    k[i] = (pl_state){at.v_m_s, acceleration(at.r_m)};
    const double step = i == 2 ? h : 0.5 * h;
    at = (pl_state){pl_vec3_madd(y->r_m, step, k[i].r_m), pl_vec3_madd(y->v_m_s, step, k[i].v_m_s)};
  }
  const double w[4] = {h / 6.0, h / 3.0, h / 3.0, h / 6.0};
  for (int i = 0; i < 4; i++) {
    y->r_m = pl_vec3_madd(y->r_m, w[i], k[i].r_m);
    y->v_m_s = pl_vec3_madd(y->v_m_s, w[i], k[i].v_m_s);
  }
}

/* Largest distance within a day from the integration of the same state; steps of 10 s are good to
 * 20 m a day. */
static double error_of(const pl_orbit *orbit, bool osculating) {
  pl_propagator *path;
  assert_int_equal(
      pl_j2_create(orbit, EARTH, osculating, PL_QUAT_IDENTITY, PL_QUAT_IDENTITY, &path), PL_OK);
  pl_state y, got;
  const double start = 0.0;
  assert_int_equal(pl_orbit_states(orbit, 1, &start, &y), PL_OK);
  double worst = 0.0;
  for (int i = 1; i <= 8640; i++) {
    const double t = 10.0 * i;
    rk4(&y, 10.0);
    assert_int_equal(pl_propagator_states(path, 1, &t, &got), PL_OK);
    worst = fmax(worst, distance(y.r_m, got.r_m));
  }
  pl_propagator_destroy(path);
  return worst;
}

/* The stated error: osculating states at every place of the orbit. */
static void test_mean_elements(void **state) {
  (void)state;
  double with = 0.0, without = 0.0;
  for (int k = 0; k < 12; k++) {
    const double a = 6778e3 + 70e3 * k, n = sqrt(GM / (a * a * a));
    const pl_orbit orbit =
        orbit_of(ellipse(a, 0.001 + 0.001 * k, (30.0 + 12.0 * k) * DEG, 0.5, 0.3 * k, k * 0.7 / n));
    const double corrected = error_of(&orbit, true);
    assert_true(corrected < 30e3);
    with = fmax(with, corrected);
    without = fmax(without, error_of(&orbit, false));
  }
  print_message("j2 within a day: %.1f km with mean elements, %.0f km without\n", with / 1e3,
                without / 1e3);
  assert_true(without > 500e3);
}

static void test_errors(void **state) {
  (void)state;
  pl_propagator *path = NULL;
  const pl_quat q = PL_QUAT_IDENTITY;
  pl_orbit orbit = orbit_of((pl_elements){7e6, 1.0, 0, 0, 0, 0});
  assert_int_equal(pl_j2_create(&orbit, EARTH, true, q, q, &path), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "eccentricity is 1"));
  orbit = orbit_of((pl_elements){7e6, 0.0, 0, 0, 0, 0});
  assert_int_equal(pl_j2_create(&orbit, (pl_flattening){NAN, 6e6}, true, q, q, &path), PL_E_RANGE);
  assert_int_equal(pl_j2_create(&orbit, (pl_flattening){1e-3, 0.0}, true, q, q, &path), PL_E_RANGE);
  assert_null(path);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_rates),    cmocka_unit_test(test_states),
      cmocka_unit_test(test_velocity), cmocka_unit_test(test_mean_elements),
      cmocka_unit_test(test_errors),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
