/* Interpolated states: exact at the rows, exact for polynomials, the stated error for orbits. */
#include "harness.h"

#include <string.h>

#include "orbit/elements.h"
#include "orbit/table.h"
#include "random.h"

enum { ROWS = 200 };

static double distance(pl_vec3 a, pl_vec3 b) { return pl_vec3_norm(pl_vec3_sub(a, b)); }

/* Rows of an orbit `step` seconds apart, unevenly by up to a fifth; columns 3 or 6. */
static void sample(const pl_orbit *orbit, double step, size_t columns, double *t, double *values) {
  test_random random = {.seed = 11};
  for (int i = 0; i < ROWS; i++) {
    pl_state s;
    t[i] = -1000.0 + step * (i + random_range(&random, -0.1, 0.1));
    assert_int_equal(pl_orbit_states(orbit, 1, &t[i], &s), PL_OK);
    memcpy(values + columns * (size_t)i, &s, columns * sizeof(double));
  }
}

static pl_orbit low_orbit(void) {
  const pl_elements el = {6778e3, 0.01, 0.9, 1.0, 2.0, 0.0};
  pl_orbit out;
  assert_int_equal(pl_orbit_from_elements(&el, 398600.4418e9, &out), PL_OK);
  return out;
}

static pl_propagator *make(const double *t, const double *values, bool velocities, int degree) {
  pl_propagator *out = NULL;
  const pl_table_rows rows = {ROWS, t, values, velocities};
  assert_int_equal(pl_table_create(&rows, degree, &out), PL_OK);
  return out;
}

/* Bit by bit, velocities too where they are given; both ends belong to the table. */
static void test_exact_at_rows(void **state) {
  (void)state;
  double t[ROWS], values[6 * ROWS];
  const pl_orbit orbit = low_orbit();
  for (int columns = 3; columns <= 6; columns += 3)
    for (int degree = 3; degree <= 25; degree += 2) {
      sample(&orbit, 60.0, (size_t)columns, t, values);
      pl_propagator *table = make(t, values, columns == 6, degree);
      pl_state got[ROWS];
      assert_int_equal(pl_propagator_states(table, ROWS, t, got), PL_OK);
      for (int i = 0; i < ROWS; i++)
        assert_memory_equal(&got[i], values + columns * i, (size_t)columns * sizeof(double));
      pl_propagator_destroy(table);
    }
}

/* Worst errors of place and velocity between the rows. */
static void errors_of(bool velocities, int degree, double *place, double *speed) {
  double t[ROWS], values[6 * ROWS];
  const pl_orbit orbit = low_orbit();
  sample(&orbit, 60.0, velocities ? 6 : 3, t, values);
  pl_propagator *table = make(t, values, velocities, degree);
  *place = *speed = 0.0;
  for (double s = t[16]; s < t[ROWS - 16]; s += 7.3) {
    pl_state got, truth;
    assert_int_equal(pl_propagator_states(table, 1, &s, &got), PL_OK);
    assert_int_equal(pl_orbit_states(&orbit, 1, &s, &truth), PL_OK);
    *place = fmax(*place, distance(got.r_m, truth.r_m));
    *speed = fmax(*speed, distance(got.v_m_s, truth.v_m_s));
  }
  pl_propagator_destroy(table);
}

static void test_stated_error(void **state) {
  (void)state;
  double place, speed;
  for (int degree = 3; degree <= 11; degree += 2)
    for (int velocities = 0; velocities < 2; velocities++) {
      errors_of(velocities, degree, &place, &speed);
      print_message("degree %2d %s velocities: %.1e m, %.1e m/s\n", degree,
                    velocities ? "with   " : "without", place, speed);
    }
  errors_of(true, 7, &place, &speed);
  assert_true(place < 1e-6 && speed < 1e-6);
  errors_of(false, 7, &place, &speed);
  assert_true(place < 1e-4 && speed < 1e-5);
  /* high degrees do not lose what rounding leaves */
  errors_of(true, 25, &place, &speed);
  assert_true(place < 1e-7 && speed < 1e-7);
  errors_of(false, 15, &place, &speed);
  assert_true(place < 1e-7 && speed < 1e-7);
}

/* Three polynomials in t/1e5, and their derivatives. */
typedef struct curves {
  double c[3][10];
  int degree;
} curves;

static pl_state curves_at(const curves *curves, double t) {
  double p[3] = {0}, d[3] = {0};
  const double x = t / 1e5;
  for (int k = 0; k < 3; k++)
    for (int j = curves->degree; j >= 0; j--) {
      d[k] = d[k] * x + p[k];
      p[k] = p[k] * x + curves->c[k][j];
    }
  return (pl_state){{p[0], p[1], p[2]}, {d[0] / 1e5, d[1] / 1e5, d[2] / 1e5}};
}

static void assert_returned(const curves *curves, size_t columns) {
  double t[ROWS], values[6 * ROWS];
  for (size_t i = 0; i < ROWS; i++) {
    t[i] = 1e5 * (2.0 * (double)i / (ROWS - 1) - 1.0);
    const pl_state s = curves_at(curves, t[i]);
    memcpy(values + columns * i, &s, columns * sizeof(double));
  }
  pl_propagator *table = make(t, values, columns == 6, curves->degree);
  for (double at = -1e5; at <= 1e5; at += 321.0) {
    pl_state got;
    assert_int_equal(pl_propagator_states(table, 1, &at, &got), PL_OK);
    const pl_state s = curves_at(curves, at);
    assert_true(distance(got.r_m, s.r_m) < 1e-12);
    assert_true(distance(got.v_m_s, s.v_m_s) * 1e5 < 1e-8);
  }
  pl_propagator_destroy(table);
}

/* Polynomials of the degree come back, in the middle and at the ends, derivatives too. */
static void test_polynomials(void **state) {
  (void)state;
  test_random random = {.seed = 4};
  for (int degree = 1; degree <= 9; degree++) {
    curves curves = {.degree = degree};
    for (int k = 0; k < 3; k++)
      for (int j = 0; j <= degree; j++)
        curves.c[k][j] = random_range(&random, -1, 1);
    assert_returned(&curves, 3);
    if (degree % 2 == 1 && degree > 1)
      assert_returned(&curves, 6);
  }
}

static void test_errors(void **state) {
  (void)state;
  double t[4] = {0, 1, 2, 3}, values[24] = {0};
  pl_propagator *table = NULL;
  pl_table_rows rows = {4, t, values, true};
  assert_int_equal(pl_table_create(&rows, 0, &table), PL_E_RANGE);
  assert_int_equal(pl_table_create(&rows, 26, &table), PL_E_RANGE);
  assert_int_equal(pl_table_create(&rows, 4, &table), PL_E_RANGE);
  assert_int_equal(pl_table_create(&rows, 1, &table), PL_E_RANGE);
  assert_int_equal(pl_table_create(&rows, 9, &table), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "degree 9 needs 5 rows, but the table has 4"));
  t[2] = 1.0;
  assert_int_equal(pl_table_create(&rows, 3, &table), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "row 2: t_s is 1"));
  t[2] = 2.0;
  values[7] = NAN;
  assert_int_equal(pl_table_create(&rows, 3, &table), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "row 1"));
  assert_null(table);
  values[7] = 0.0;
  assert_int_equal(pl_table_create(&rows, 3, &table), PL_OK);
  const double outside[2] = {-1e-9, 3.5};
  pl_state got;
  for (int i = 0; i < 2; i++) {
    assert_int_equal(pl_propagator_states(table, 1, &outside[i], &got), PL_E_RANGE);
    assert_non_null(strstr(pl_error_text(), "is outside the table, which goes from 0 to 3 s"));
  }
  pl_propagator_destroy(table);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_exact_at_rows),
      cmocka_unit_test(test_stated_error),
      cmocka_unit_test(test_polynomials),
      cmocka_unit_test(test_errors),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
