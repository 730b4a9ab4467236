/* What is put on top of axes: a fixed rotation, a spin about an own or a fixed axis. */
#include "harness.h"

#include <string.h>

#include "orbit/turn.h"
#include "random.h"

static double angle(pl_quat a, pl_quat b) {
  const pl_quat d = pl_quat_mul(pl_quat_conjugate(a), b);
  return 2.0 * atan2(sqrt(d.x * d.x + d.y * d.y + d.z * d.z), fabs(d.w));
}

static pl_quat turned(pl_turn turn, const pl_turn_view *view) {
  pl_quat q;
  assert_int_equal(pl_turn_prepare(&turn), PL_OK);
  assert_int_equal(pl_turn_at(&turn, view, &q), PL_OK);
  return q;
}

/* axes * q * spin, q and axis of any length; a fixed axis a is q^-1 a (the paper's mode global). */
static void test_composition(void **state) {
  (void)state;
  test_random random = {.seed = 31};
  pl_turn turn = PL_TURN_NONE;
  assert_int_equal(pl_turn_require("parent", &turn.kind), PL_OK);
  for (int n = 0; n < 1000; n++) {
    const pl_quat axes = random_rotation(&random), q = random_rotation(&random);
    const pl_vec3 axis = random_direction(&random);
    const pl_turn_view view = {.parent = axes, .t_s = random_range(&random, -1e3, 1e3)};
    turn.q = (pl_quat){-3.0 * q.w, -3.0 * q.x, -3.0 * q.y, -3.0 * q.z};
    turn.rate_rad_s = random_range(&random, -1, 1);
    turn.axis = pl_vec3_scale(axis, 5.0);
    const pl_quat spin = pl_quat_axis_angle(axis, turn.rate_rad_s * view.t_s);
    assert_true(angle(turned(turn, &view), pl_quat_mul(pl_quat_mul(axes, q), spin)) < 1e-12);
    turn.axis = pl_quat_rotate_inverse(q, axis);
    assert_true(angle(turned(turn, &view), pl_quat_mul(pl_quat_mul(axes, spin), q)) < 1e-12);
  }
}

/* Without either the axes come back bit by bit. */
static void test_plain(void **state) {
  (void)state;
  const pl_turn_view view = {.parent = {0.1, 0.7, -0.1, 0.7}, .t_s = 1e9};
  pl_turn turn = PL_TURN_NONE;
  const pl_quat none = turned(turn, &view), identity = PL_QUAT_IDENTITY;
  assert_memory_equal(&none, &identity, sizeof none);
  assert_int_equal(pl_turn_require("parent", &turn.kind), PL_OK);
  const pl_quat got = turned(turn, &view);
  assert_memory_equal(&got, &view.parent, sizeof got);
}

/* Names are there once, and each says what it is. */
static void test_kinds(void **state) {
  (void)state;
  size_t count;
  const pl_turn_kind *kinds = pl_turn_kinds(&count), *found;
  for (size_t i = 0; i < count; i++) {
    assert_true(strlen(kinds[i].doc) > 10);
    assert_int_equal(pl_turn_require(kinds[i].name, &found), PL_OK);
    assert_ptr_equal(found, &kinds[i]);
  }
  assert_int_equal(pl_turn_require("nadir", &found), PL_E_ARGUMENT);
  for (size_t i = 0; i < count; i++)
    assert_non_null(strstr(pl_error_text(), kinds[i].name));
}

static void test_errors(void **state) {
  (void)state;
  static const char *const needy[] = {"body", "sun", "target", "tumble", "table"};
  for (size_t i = 0; i < sizeof needy / sizeof needy[0]; i++) {
    pl_turn turn = PL_TURN_NONE;
    assert_int_equal(pl_turn_require(needy[i], &turn.kind), PL_OK);
    assert_int_not_equal(pl_turn_prepare(&turn), PL_OK);
  }
  pl_turn turn = PL_TURN_NONE;
  turn.rate_rad_s = INFINITY;
  assert_int_equal(pl_turn_prepare(&turn), PL_E_RANGE);
  turn.rate_rad_s = 1.0;
  turn.axis = (pl_vec3){0};
  assert_int_equal(pl_turn_prepare(&turn), PL_E_RANGE);
  turn = PL_TURN_NONE;
  assert_int_equal(pl_turn_require("sun", &turn.kind), PL_OK);
  turn.towards = 0;
  turn.up.x = NAN;
  assert_int_equal(pl_turn_prepare(&turn), PL_E_RANGE);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_composition),
      cmocka_unit_test(test_plain),
      cmocka_unit_test(test_kinds),
      cmocka_unit_test(test_errors),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
