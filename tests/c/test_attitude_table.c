/* Tables of attitudes: exact at rows, a constant rate between, signs of quaternions, errors. */
#include "harness.h"

#include <string.h>

#include "orbit/attitude_table.h"
#include "random.h"

enum { ROWS = 50 };

static double angle(pl_quat a, pl_quat b) {
  const pl_quat d = pl_quat_mul(pl_quat_conjugate(a), b);
  return 2.0 * atan2(sqrt(d.x * d.x + d.y * d.y + d.z * d.z), fabs(d.w));
}

/* A spin of 0.1 rad/s, rows at uneven times with random signs and sizes, comes back everywhere. */
static void test_spin(void **state) {
  (void)state;
  test_random random = {.seed = 6};
  const pl_vec3 axis = random_direction(&random);
  double t[ROWS];
  pl_quat q[ROWS], got;
  for (int i = 0; i < ROWS; i++) {
    t[i] = -100.0 + 10.0 * (i + random_range(&random, -0.4, 0.4));
    const pl_quat unit = pl_quat_axis_angle(axis, 0.1 * t[i]);
    const double k = random_range(&random, 0.5, 2.0) * (random_below(&random, 2) ? 1.0 : -1.0);
    q[i] = (pl_quat){k * unit.w, k * unit.x, k * unit.y, k * unit.z};
  }
  const pl_attitude_table table = {ROWS, t, q};
  assert_int_equal(pl_attitude_table_check(&table), PL_OK);
  for (double s = t[0]; s <= t[ROWS - 1]; s += 0.37) {
    assert_int_equal(pl_attitude_table_at(&table, s, &got), PL_OK);
    assert_true(angle(got, pl_quat_axis_angle(axis, 0.1 * s)) < 1e-14);
  }
  for (int i = 0; i < ROWS; i++) {
    const pl_quat unit = pl_quat_unit(q[i]);
    assert_int_equal(pl_attitude_table_at(&table, t[i], &got), PL_OK);
    assert_memory_equal(&got, &unit, sizeof got);
  }
}

/* Rows that differ by the sign and 1e-12 (hard-case row 32) are near, not a turn apart. */
static void test_opposite_signs(void **state) {
  (void)state;
  const double t[2] = {0.0, 1.0};
  const pl_quat q[2] = {PL_QUAT_IDENTITY, {-1.0, 1e-12, 0, 0}};
  pl_quat got;
  assert_int_equal(pl_attitude_table_at(&(pl_attitude_table){2, t, q}, 0.5, &got), PL_OK);
  assert_true(angle(got, pl_quat_axis_angle((pl_vec3){-1, 0, 0}, 1e-12)) < 1e-24);
}

static void test_errors(void **state) {
  (void)state;
  double t[3] = {0, 1, 2};
  pl_quat q[3] = {PL_QUAT_IDENTITY, PL_QUAT_IDENTITY, PL_QUAT_IDENTITY}, got;
  pl_attitude_table table = {3, t, q};
  const double outside[2] = {-1e-9, 2.5};
  for (int i = 0; i < 2; i++) {
    assert_int_equal(pl_attitude_table_at(&table, outside[i], &got), PL_E_RANGE);
    assert_non_null(strstr(pl_error_text(), "which goes from 0 to 2 s"));
  }
  t[2] = 1.0;
  assert_int_equal(pl_attitude_table_check(&table), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "row 2: t_s is 1"));
  t[2] = 2.0;
  q[1] = (pl_quat){0};
  assert_int_equal(pl_attitude_table_check(&table), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "row 1"));
  table.count = 0;
  assert_int_equal(pl_attitude_table_check(&table), PL_E_RANGE);
  table.count = 1; /* one row holds at its time alone */
  assert_int_equal(pl_attitude_table_check(&table), PL_OK);
  assert_int_equal(pl_attitude_table_at(&table, 0.0, &got), PL_OK);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_spin),
      cmocka_unit_test(test_opposite_signs),
      cmocka_unit_test(test_errors),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
