/* Orbit frames and pointing: axes where they are said to be, orthonormal always, degenerate cases.
 */
#include "harness.h"

#include <string.h>

#include "orbit/attitude.h"
#include "random.h"

static const pl_vec3 X = {1, 0, 0}, Y = {0, 1, 0}, Z = {0, 0, 1};

static double distance(pl_vec3 a, pl_vec3 b) { return pl_vec3_norm(pl_vec3_sub(a, b)); }
static pl_vec3 opposite(pl_vec3 a) { return pl_vec3_scale(a, -1.0); }
static pl_vec3 random_vector(test_random *random) {
  return pl_vec3_scale(random_direction(random), random_scale(random, 1e-6, 1e12));
}

/* Unit, and so a rotation of determinant 1. */
static void assert_rotation(pl_quat q) {
  assert_true(fabs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1.0) < 1e-15);
}

static void test_frames(void **state) {
  (void)state;
  test_random random = {.seed = 21};
  for (int n = 0; n < 20000; n++) {
    const pl_state s = {random_vector(&random), random_vector(&random)};
    const pl_vec3 h = pl_vec3_unit(pl_vec3_cross(s.r_m, s.v_m_s)), r = pl_vec3_unit(s.r_m);
    const pl_vec3 v = pl_vec3_unit(s.v_m_s);
    const double sine = pl_vec3_norm(pl_vec3_cross(r, v)), noise = 1e-14 / sine;
    pl_quat q;
    assert_int_equal(pl_attitude_lvlh(&s, &q), PL_OK);
    assert_rotation(q);
    assert_true(distance(pl_quat_rotate(q, Z), opposite(r)) < 1e-14);
    assert_true(distance(pl_quat_rotate(q, Y), opposite(h)) < noise);
    assert_true(pl_vec3_dot(pl_quat_rotate(q, X), v) > 0.0);
    assert_int_equal(pl_attitude_rsw(&s, &q), PL_OK);
    assert_rotation(q);
    assert_true(distance(pl_quat_rotate(q, X), r) < 1e-14);
    assert_true(distance(pl_quat_rotate(q, Z), h) < noise);
    assert_true(pl_vec3_dot(pl_quat_rotate(q, Y), v) > 0.0);
    assert_int_equal(pl_attitude_velocity(&s, &q), PL_OK);
    assert_rotation(q);
    assert_true(distance(pl_quat_rotate(q, X), v) < 1e-14);
    assert_true(distance(pl_quat_rotate(q, Y), opposite(h)) < noise);
    assert_true(pl_vec3_dot(pl_quat_rotate(q, Z), r) < 0.0);
  }
}

/* On a circular orbit the frame of the velocity is lvlh; rsw is lvlh relabelled. */
static void test_frames_agree(void **state) {
  (void)state;
  const pl_state s = {{7e6, 0, 0}, {0, 5e3, 5e3}};
  pl_quat a, b, c;
  assert_int_equal(pl_attitude_lvlh(&s, &a), PL_OK);
  assert_int_equal(pl_attitude_velocity(&s, &b), PL_OK);
  assert_int_equal(pl_attitude_rsw(&s, &c), PL_OK);
  assert_true(distance(pl_quat_rotate(a, X), pl_quat_rotate(b, X)) < 1e-15);
  assert_true(distance(pl_quat_rotate(a, Z), pl_quat_rotate(b, Z)) < 1e-15);
  assert_true(distance(pl_quat_rotate(a, X), pl_quat_rotate(c, Y)) < 1e-15);
  assert_true(distance(pl_quat_rotate(a, Y), opposite(pl_quat_rotate(c, Z))) < 1e-15);
}

static void test_aim(void **state) {
  (void)state;
  test_random random = {.seed = 22};
  for (int n = 0; n < 20000; n++) {
    const pl_vec3 aim = random_vector(&random), up = random_vector(&random);
    const pl_vec3 u = pl_vec3_unit(aim);
    pl_quat q;
    assert_int_equal(pl_attitude_aim_x(aim, up, &q), PL_OK);
    assert_rotation(q);
    assert_true(distance(pl_quat_rotate(q, X), u) < 1e-14);
    /* z is in the plane of aim and up, on the side of up: no other square direction is nearer */
    const double sine = pl_vec3_norm(pl_vec3_cross(u, pl_vec3_unit(up)));
    const pl_vec3 z = pl_quat_rotate(q, Z), y = pl_quat_rotate(q, Y);
    assert_true(pl_vec3_dot(z, up) > 0.0);
    assert_true(fabs(pl_vec3_dot(y, pl_vec3_unit(up))) < 1e-14 / sine);
    assert_int_equal(pl_attitude_aim_z(aim, up, &q), PL_OK);
    assert_rotation(q);
    assert_true(distance(pl_quat_rotate(q, Z), u) < 1e-14);
    assert_true(pl_vec3_dot(pl_quat_rotate(q, Y), up) < 0.0);
    assert_true(fabs(pl_vec3_dot(pl_quat_rotate(q, X), pl_vec3_unit(up))) < 1e-14 / sine);
  }
}

/* To the centre with the orbit normal up, target pointing is lvlh. */
static void test_aim_at_the_centre_is_lvlh(void **state) {
  (void)state;
  test_random random = {.seed = 23};
  for (int n = 0; n < 1000; n++) {
    const pl_state s = {random_vector(&random), random_vector(&random)};
    pl_quat a, b;
    assert_int_equal(pl_attitude_lvlh(&s, &a), PL_OK);
    assert_int_equal(pl_attitude_aim_z(opposite(s.r_m), pl_attitude_normal(&s), &b), PL_OK);
    for (int k = 0; k < 3; k++) {
      const pl_vec3 axis = k == 0 ? X : k == 1 ? Y : Z;
      assert_true(distance(pl_quat_rotate(a, axis), pl_quat_rotate(b, axis)) < 1e-14);
    }
  }
}

/* No motion, radial motion, the centre, the pole, up along the aim (hard-case row 30): a rotation
 * or an error, the same for the same arguments, never NaN. */
static void test_degenerate(void **state) {
  (void)state;
  const pl_vec3 axes[] = {X, Y, Z, {0, 0, -1}, {1, 1, 1}, {1e-3, 0, 1}, {1e-200, 0, 0}};
  pl_quat q, same;
  for (size_t i = 0; i < sizeof axes / sizeof axes[0]; i++) {
    const double size = pl_vec3_norm(axes[i]) > 1e-100 ? 7e6 : 1e200;
    const pl_vec3 r = pl_vec3_scale(axes[i], size);
    const pl_state still = {r, {0, 0, 0}}, radial = {r, pl_vec3_scale(r, -1e-3)};
    const pl_state *cases[] = {&still, &radial};
    for (int k = 0; k < 2; k++) {
      assert_int_equal(pl_attitude_lvlh(cases[k], &q), PL_OK);
      assert_rotation(q);
      assert_true(distance(pl_quat_rotate(q, Z), opposite(pl_vec3_unit(r))) < 1e-14);
      assert_int_equal(pl_attitude_rsw(cases[k], &q), PL_OK);
      assert_rotation(q);
    }
    assert_int_equal(pl_attitude_velocity(&radial, &q), PL_OK);
    assert_rotation(q);
    assert_true(distance(pl_quat_rotate(q, X), opposite(pl_vec3_unit(r))) < 1e-14);
    assert_int_equal(pl_attitude_velocity(&still, &q), PL_E_RANGE);
    for (double sign = -1.0; sign <= 1.0; sign += 1.0) { /* 0: no up at all */
      const pl_vec3 up = pl_vec3_scale(r, sign);
      assert_int_equal(pl_attitude_aim_x(r, up, &q), PL_OK);
      assert_rotation(q);
      assert_true(distance(pl_quat_rotate(q, X), pl_vec3_unit(r)) < 1e-14);
      assert_int_equal(pl_attitude_aim_x(r, up, &same), PL_OK);
      assert_memory_equal(&q, &same, sizeof q);
      assert_int_equal(pl_attitude_aim_z(r, up, &q), PL_OK);
      assert_rotation(q);
    }
  }
  const pl_state centre = {{0, 0, 0}, {1, 0, 0}};
  assert_int_equal(pl_attitude_lvlh(&centre, &q), PL_E_RANGE);
  assert_int_equal(pl_attitude_rsw(&centre, &q), PL_E_RANGE);
  assert_int_equal(pl_attitude_aim_x(centre.r_m, Z, &q), PL_E_RANGE);
  assert_int_equal(pl_attitude_aim_z((pl_vec3){NAN, 0, 0}, Z, &q), PL_E_RANGE);
}

/* Smooth up to 1e-6 rad from the singular direction. */
static void test_aim_is_smooth(void **state) {
  (void)state;
  pl_quat before = {0}, q;
  for (double angle = 2e-6; angle < 3.14159; angle *= 1.01) {
    const pl_vec3 aim = {sin(angle), 0, cos(angle)};
    assert_int_equal(pl_attitude_aim_x(aim, Z, &q), PL_OK);
    if (angle > 2e-6) {
      const pl_quat d = pl_quat_mul(pl_quat_conjugate(before), q);
      const double turned = 2.0 * atan2(sqrt(d.x * d.x + d.y * d.y + d.z * d.z), fabs(d.w));
      assert_true(turned < 0.0101 * angle);
    }
    before = q;
  }
}

/* 1 rpm for 30 years: the phase is that of the product of the doubles, with 50 digits (mpmath). The
 * product alone, rounded, would be off by 1e-8. */
static void test_long_spin(void **state) {
  (void)state;
  const pl_quat q = pl_attitude_spin(PL_QUAT_IDENTITY, Z, 0.1047197551196598, 946728000.3);
  const double sign = q.w < 0.0 ? -1.0 : 1.0;
  assert_true(fabs(sign * q.z - 0.015707323830699061) < 1e-15);
  assert_true(fabs(sign * q.w - 0.99987663237925385) < 1e-15);
}

static void test_check(void **state) {
  (void)state;
  assert_int_equal(pl_attitude_check((pl_quat){0}, "q"), PL_E_RANGE);
  assert_string_equal(pl_error_text(), "the quaternion q must be finite and not zero");
  assert_int_equal(pl_attitude_check((pl_quat){NAN, 0, 0, 1}, "q"), PL_E_RANGE);
  assert_int_equal(pl_attitude_check((pl_quat){0, 0, 0, -3}, "q"), PL_OK);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_frames),     cmocka_unit_test(test_frames_agree),
      cmocka_unit_test(test_aim),        cmocka_unit_test(test_aim_at_the_centre_is_lvlh),
      cmocka_unit_test(test_degenerate), cmocka_unit_test(test_aim_is_smooth),
      cmocka_unit_test(test_long_spin),  cmocka_unit_test(test_check),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
