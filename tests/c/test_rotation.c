/* Quaternions, matrices, slerp and poses. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "math/philox.h"
#include "math/rotation.h"

static double uniform(uint64_t index, uint64_t which) {
  uint64_t out[4];
  pl_philox((uint64_t[2]){3, which}, (uint64_t[4]){index, 0, 0, 0}, out);
  return 2.0 * pl_philox_double(out[0]) - 1.0;
}
static pl_vec3 vector(uint64_t i, uint64_t which) {
  return pl_vec3_make(uniform(i, which), uniform(i, which + 1), uniform(i, which + 2));
}
static pl_quat rotation(uint64_t i, uint64_t which) {
  return pl_quat_unit((pl_quat){uniform(i, which), uniform(i, which + 1), uniform(i, which + 2),
                                uniform(i, which + 3)});
}
static double distance(pl_vec3 a, pl_vec3 b) { return pl_vec3_norm(pl_vec3_sub(a, b)); }
static double dot4(pl_quat a, pl_quat b) { return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z; }

static void test_axis_angle(void **state) {
  (void)state;
  const pl_quat q = pl_quat_axis_angle(pl_vec3_make(0, 0, 1), 0.5 * PL_PI);
  assert_true(distance(pl_quat_rotate(q, pl_vec3_make(1, 0, 0)), pl_vec3_make(0, 1, 0)) < 1e-15);
  const pl_quat tiny = pl_quat_axis_angle(pl_vec3_make(0, 0, 1), 1e-9);
  assert_true(fabs(pl_quat_rotate(tiny, pl_vec3_make(1, 0, 0)).y - 1e-9) < 1e-24);
}

/* Rotations keep lengths, compose, invert, and agree with their matrices. */
static void test_algebra(void **state) {
  (void)state;
  for (uint64_t i = 0; i < 2000; i++) {
    const pl_quat a = rotation(i, 0), b = rotation(i, 10);
    const pl_vec3 v = vector(i, 20);
    const pl_vec3 ab = pl_quat_rotate(pl_quat_mul(a, b), v);
    assert_true(distance(ab, pl_quat_rotate(a, pl_quat_rotate(b, v))) < 4e-15);
    assert_true(fabs(pl_vec3_norm(ab) - pl_vec3_norm(v)) < 4e-15);
    assert_true(distance(pl_quat_rotate_inverse(a, pl_quat_rotate(a, v)), v) < 4e-15);
    const pl_mat3 ma = pl_mat3_from_quat(a), mb = pl_mat3_from_quat(b);
    assert_true(distance(pl_mat3_mul_vec(ma, v), pl_quat_rotate(a, v)) < 4e-15);
    assert_true(distance(pl_mat3_mul_vec_t(ma, v), pl_quat_rotate_inverse(a, v)) < 4e-15);
    assert_true(distance(pl_mat3_mul_vec(pl_mat3_mul(ma, mb), v), ab) < 4e-15);
    const pl_quat back = pl_quat_from_mat3(ma);
    assert_true(fabs(fabs(dot4(back, a)) - 1.0) < 1e-15);
  }
}

/* Half turns, where the trace is -1 and a trace-only conversion fails. */
static void test_half_turns(void **state) {
  (void)state;
  for (uint64_t i = 0; i < 1000; i++) {
    pl_vec3 axis = pl_vec3_unit(vector(i, 40));
    if (i < 3)
      axis = pl_vec3_make(i == 0, i == 1, i == 2);
    const pl_quat q = pl_quat_axis_angle(axis, PL_PI);
    const pl_quat back = pl_quat_from_mat3(pl_mat3_from_quat(q));
    assert_true(fabs(fabs(dot4(back, q)) - 1.0) < 1e-15);
  }
}

static void test_slerp(void **state) {
  (void)state;
  const pl_vec3 z = {0, 0, 1};
  for (int k = 0; k <= 10; k++) {
    const pl_quat a = pl_quat_axis_angle(z, 0.2), b = pl_quat_axis_angle(z, 1.6);
    const pl_quat minus_b = {-b.w, -b.x, -b.y, -b.z};
    const pl_quat expected = pl_quat_axis_angle(z, 0.2 + 0.14 * k);
    assert_true(1.0 - dot4(pl_quat_slerp(a, b, 0.1 * k), expected) < 1e-15);
    assert_true(1.0 - dot4(pl_quat_slerp(a, minus_b, 0.1 * k), expected) < 1e-15);
  }
  /* nearly opposite quaternions are nearly the same rotation: no long way, no NaN */
  const pl_quat a = pl_quat_axis_angle(z, 0.3), near = pl_quat_axis_angle(z, 0.3 + 1e-6);
  const pl_quat middle = pl_quat_slerp(a, (pl_quat){-near.w, -near.x, -near.y, -near.z}, 0.5);
  assert_true(fabs(2.0 * atan2(middle.z, middle.w) - (0.3 + 5e-7)) < 1e-15);
  /* nor between one rotation and itself, whose angle is 0 */
  const pl_quat half = {0.0, 0.0, 0.0, 1.0};
  assert_true(pl_quat_slerp(half, half, 0.3).z == 1.0);
}

static void test_degenerate(void **state) {
  (void)state;
  assert_true(pl_quat_unit((pl_quat){0, 0, 0, 0}).w == 1.0);
  assert_true(pl_quat_unit((pl_quat){NAN, 0, 0, 0}).w == 1.0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_axis_angle), cmocka_unit_test(test_algebra),
      cmocka_unit_test(test_half_turns), cmocka_unit_test(test_slerp),
      cmocka_unit_test(test_degenerate),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
