/* Free rotation: reference values, what Euler's equations keep, and every degenerate body. */
#include "harness.h"

#include <string.h>

#include "orbit/tumble.h"
#include "random.h"

static pl_vec3 momentum(pl_vec3 inertia, pl_vec3 w) {
  return (pl_vec3){inertia.x * w.x, inertia.y * w.y, inertia.z * w.z};
}
static double distance(pl_vec3 a, pl_vec3 b) { return pl_vec3_norm(pl_vec3_sub(a, b)); }

/* Angle between two rotations, radians. */
static double angle(pl_quat a, pl_quat b) {
  const pl_quat d = pl_quat_mul(pl_quat_conjugate(a), b);
  return 2.0 * atan2(sqrt(d.x * d.x + d.y * d.y + d.z * d.z), fabs(d.w));
}

static pl_tumble tumble(pl_vec3 inertia, pl_vec3 w, pl_quat start) {
  pl_tumble out;
  assert_int_equal(pl_tumble_init(inertia, w, start, &out), PL_OK);
  return out;
}

/* 40-digit integration, from the science sheet. */
static void test_reference(void **state) {
  (void)state;
  const pl_tumble t = tumble((pl_vec3){1, 2, 3}, (pl_vec3){0.5, 0, 1}, PL_QUAT_IDENTITY);
  static const struct {
    double t;
    pl_vec3 w;
  } rates[] = {
      {1.0, {0.274908606147688, 0.417642500550334, 0.97049381618055}},
      {10.0, {-0.46644871885578, -0.180071076738608, 0.994581052055286}},
      {100.0, {-0.443676643855597, -0.230545083870886, 0.991101906012186}},
      {0.0, {0.5, 0.0, 1.0}},
      {6.42060031236159, {0.5, 0.0, 1.0}}, /* the period */
      {-6.42060031236159, {0.5, 0.0, 1.0}},
  };
  for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
    pl_vec3 w;
    pl_tumble_at(&t, rates[i].t, &w);
    assert_true(distance(w, rates[i].w) < 2e-14);
  }
  const pl_quat one = {0.852772775908209, 0.18324927752225, 0.10011395087742, 0.47872277133754};
  const pl_quat ten = {0.464659820840228, -0.0328759741870427, 0.127748385510497,
                       -0.875608800331199};
  assert_true(angle(pl_tumble_at(&t, 1.0, NULL), one) < 1e-14);
  assert_true(angle(pl_tumble_at(&t, 10.0, NULL), ten) < 1e-14);
  assert_true(angle(pl_tumble_at(&t, 0.0, NULL), PL_QUAT_IDENTITY) < 1e-15);
}

/* Energy, momentum in the outer frame, and both equations of motion by central differences. */
static void assert_motion(pl_vec3 inertia, pl_vec3 w0, pl_quat start, double t_s) {
  const pl_tumble t = tumble(inertia, w0, start);
  const pl_vec3 l0 = pl_quat_rotate(start, momentum(inertia, w0));
  const double e0 = pl_vec3_dot(w0, momentum(inertia, w0)), speed = pl_vec3_norm(w0);
  pl_vec3 w, before, after;
  const pl_quat q = pl_tumble_at(&t, t_s, &w);
  const double norm = sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  assert_true(fabs(norm - 1.0) < 4e-16);
  assert_true(fabs(pl_vec3_dot(w, momentum(inertia, w)) - e0) <= 1e-13 * e0);
  const pl_vec3 l = pl_quat_rotate(q, momentum(inertia, w));
  assert_true(distance(l, l0) <= 1e-13 * pl_vec3_norm(l0));
  /* phases of u and of the precession are known to eps |t|: steps must be well above that */
  const double h = 1e-3 / speed, noise = 4e-15 * (1.0 + fabs(t_s) * speed) / 1e-3;
  const pl_quat q1 = pl_tumble_at(&t, t_s - h, &before), q2 = pl_tumble_at(&t, t_s + h, &after);
  const pl_vec3 torque = pl_vec3_cross(momentum(inertia, w), w);
  const pl_vec3 rate = pl_vec3_scale(pl_vec3_sub(after, before), 0.5 / h);
  const double most = fmax(inertia.x, fmax(inertia.y, inertia.z));
  const double least = fmin(inertia.x, fmin(inertia.y, inertia.z));
  const double ratio = most / least;
  assert_true(distance(momentum(inertia, rate), torque) <=
              (1e-5 * ratio * ratio + noise) * most * speed * speed * ratio);
  const pl_quat step = pl_quat_mul(pl_quat_conjugate(q1), q2);
  const double sign = step.w < 0.0 ? -1.0 : 1.0;
  const pl_vec3 turned = pl_vec3_scale((pl_vec3){step.x, step.y, step.z}, sign / h);
  assert_true(distance(turned, w) <= (1e-5 * ratio * ratio + noise) * speed * ratio);
}

static void test_random_bodies(void **state) {
  (void)state;
  test_random random = {.seed = 71};
  for (int n = 0; n < 20000; n++) {
    const double scale = random_scale(&random, 1e-3, 1e6);
    /* masses on three axes give moments that some body has; in every order of axes */
    const double x = random_scale(&random, 0.1, 1), y = random_scale(&random, 0.1, 1),
                 z = random_scale(&random, 0.1, 1);
    const pl_vec3 inertia = {scale * (y + z), scale * (z + x), scale * (x + y)};
    const double speed = random_scale(&random, 1e-4, 10);
    const pl_vec3 w = pl_vec3_scale(random_direction(&random), speed);
    const double t = random_range(&random, -1e5, 1e5) / speed;
    assert_motion(inertia, w, random_rotation(&random), t);
  }
}

/* Symmetric about each axis, all but symmetric, a sphere, a plate, principal spins, and spins that
 * leave a principal axis by little. */
static void test_special_bodies(void **state) {
  (void)state;
  static const double offs[] = {0.0, 1e-300, 1e-160, 1e-100, 1e-16, 1e-12, 1e-8, 1e-6, 1e-3, 0.3};
  static const double moments[] = {1.0, 1.0 + 1e-15, 1.0 + 1e-12, 1.0 + 1e-6, 1.5, 2.0, 3.0};
  enum { OFFS = sizeof offs / sizeof offs[0], MOMENTS = sizeof moments / sizeof moments[0] };
  test_random random = {.seed = 5};
  for (int i = 0; i < MOMENTS; i++)
    for (int j = 0; j < MOMENTS; j++)
      for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < OFFS; k++) {
          double in[3] = {1.0, moments[i], moments[j]};
          if (fabs(in[2] - in[1]) > in[0] || in[2] + in[1] < in[0])
            continue;
          const double a = in[axis], sign = k % 2 ? 1.0 : -1.0;
          in[axis] = in[0];
          in[0] = a;
          double w[3] = {offs[k], offs[(k + axis) % OFFS] * sign, offs[k] * sign};
          w[(axis + k) % 3] = sign;
          const double times[] = {0.0, 1.0, 30.0, -777.7, random_range(&random, -1e4, 1e4)};
          for (int n = 0; n < 5; n++)
            assert_motion((pl_vec3){in[0], in[1], in[2]}, (pl_vec3){w[0], w[1], w[2]},
                          random_rotation(&random), times[n]);
        }
}

/* I1 = I2: the rates turn about z at (I3 - I1)/I1 w3, the axis about L at L/I1 (science sheet 4).
 */
static void test_symmetric(void **state) {
  (void)state;
  const pl_vec3 inertia = {2, 2, 3}, w0 = {0.3, 0.1, 0.7};
  const pl_tumble t = tumble(inertia, w0, PL_QUAT_IDENTITY);
  const pl_vec3 l = momentum(inertia, w0), axis = pl_vec3_unit(l);
  for (double s = -50.0; s < 50.0; s += 3.3) {
    const double a = 0.5 * 0.7 * s;
    pl_vec3 w;
    const pl_quat q = pl_tumble_at(&t, s, &w);
    const pl_vec3 expected = {0.3 * cos(a) - 0.1 * sin(a), 0.1 * cos(a) + 0.3 * sin(a), 0.7};
    assert_true(distance(w, expected) < 2e-14);
    const pl_quat turned = pl_quat_mul(pl_quat_axis_angle(axis, pl_vec3_norm(l) / 2.0 * s),
                                       pl_quat_axis_angle(pl_vec3_make(0, 0, 1), -a));
    assert_true(angle(q, turned) < 1e-13);
  }
}

/* About the middle axis, 1e-6 off: the growth of the first hour is exp(rate t) with
 * rate = w sqrt((I3 - I2)(I2 - I1)/(I1 I3)); it turns over after about ln(4e6)/rate, and comes back
 * with a period of 4 K. */
static void test_turns_over(void **state) {
  (void)state;
  const pl_vec3 inertia = {1, 2, 3};
  const double small = 1e-6, rate = sqrt(1.0 / 3.0);
  /* along the unstable eigenvector: I1 w1' = (I2 - I3) w2 w3, I3 w3' = (I1 - I2) w2 w1 */
  const pl_vec3 w0 = {small * sqrt(3.0), 1.0, -small};
  const pl_tumble t = tumble(inertia, w0, PL_QUAT_IDENTITY);
  pl_vec3 w;
  pl_tumble_at(&t, 10.0, &w);
  assert_true(fabs(w.z / (-small * exp(10.0 * rate)) - 1.0) < 1e-4);
  double over = 0.0;
  while (over < 60.0 && (pl_tumble_at(&t, over, &w), w.y > 0.0))
    over += 0.01;
  /* w2 = tanh-like falls through 0 where the others are largest: |w3| = sqrt(I2(I2-I1)/(I3(I3-I1)))
   * = sqrt(1/3), having grown by 2/small of it (sech ~ 2 exp) */
  assert_true(fabs(over - log(2.0 * sqrt(1.0 / 3.0) / small) / rate) < 0.02);
}

/* On the separatrix itself the motion ends at the middle axis: tanh and sech. */
static void test_separatrix(void **state) {
  (void)state;
  /* L^2 = 2 E I2: I1 (I1 - I2) w1^2 + I3 (I3 - I2) w3^2 = 0: w1 = sqrt(3) w3 for (1, 2, 3), but
   * exact in doubles for (3, 4, 6): 3 w1^2 = 12 w3^2 */
  const pl_vec3 inertia = {3, 4, 6};
  static const double signs[][2] = {{1, 1}, {1, -1}, {-1, 1}, {-1, -1}};
  for (int i = 0; i < 4; i++) {
    const pl_vec3 w0 = {2 * signs[i][0], 0.25, signs[i][1]};
    const pl_tumble t = tumble(inertia, w0, PL_QUAT_IDENTITY);
    assert_true(isinf(t.quarter));
    static const double times[] = {0.0, 0.7, -0.7, 5.0, 20.0, -300.0, 1e9};
    for (size_t n = 0; n < sizeof times / sizeof times[0]; n++)
      if (fabs(times[n]) < 1e6)
        assert_motion(inertia, w0, PL_QUAT_IDENTITY, times[n]);
    pl_vec3 w;
    pl_tumble_at(&t, 1e9, &w);
    /* I2 w2' = (I3 - I1) w3 w1: w2 ends at the sign of the product; L^2 = 2 E I2 -> w2 = L/I2 */
    const double l = pl_vec3_norm(momentum(inertia, w0));
    assert_true(fabs(w.y - signs[i][0] * signs[i][1] * l / 4.0) < 1e-15 * l);
  }
}

/* 1e9 s at 0.1 rad/s: 16 million turns. Energy and momentum to 1e-13; the phase to eps of it. */
static void test_thirty_years(void **state) {
  (void)state;
  const pl_vec3 inertia = {1, 2, 2.8}, w0 = {0.05, 0.02, 0.08};
  const pl_tumble t = tumble(inertia, w0, PL_QUAT_IDENTITY);
  const pl_vec3 l0 = momentum(inertia, w0);
  for (double s = -1e9; s <= 1e9; s += 1.234567e8) {
    pl_vec3 w, same;
    const pl_quat q = pl_tumble_at(&t, s, &w);
    assert_true(fabs(pl_vec3_dot(w, momentum(inertia, w)) / pl_vec3_dot(w0, l0) - 1.0) < 1e-14);
    assert_true(distance(pl_quat_rotate(q, momentum(inertia, w)), l0) < 1e-14);
    /* started from there, it comes back: the periods agree */
    const pl_tumble again = tumble(inertia, w, q);
    const pl_quat back = pl_tumble_at(&again, -s, &same);
    assert_true(distance(same, w0) < 1e-16 * 8 * fabs(s) * 0.1);
    assert_true(angle(back, PL_QUAT_IDENTITY) < 1e-16 * 32 * fabs(s) * 0.1);
  }
}

static void test_errors(void **state) {
  (void)state;
  pl_tumble t;
  const pl_vec3 w = {0, 0, 1};
  assert_int_equal(pl_tumble_init((pl_vec3){1, 1, 0}, w, PL_QUAT_IDENTITY, &t), PL_E_RANGE);
  assert_int_equal(pl_tumble_init((pl_vec3){1, 1, NAN}, w, PL_QUAT_IDENTITY, &t), PL_E_RANGE);
  assert_int_equal(pl_tumble_init((pl_vec3){1, 1, 2.1}, w, PL_QUAT_IDENTITY, &t), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "no body has a moment larger"));
  assert_int_equal(
      pl_tumble_init((pl_vec3){1, 1, 2}, (pl_vec3){0, INFINITY, 0}, PL_QUAT_IDENTITY, &t),
      PL_E_RANGE);
  assert_int_equal(pl_tumble_init((pl_vec3){1, 1, 2}, w, (pl_quat){0}, &t), PL_E_RANGE);
  t = tumble((pl_vec3){1, 2, 2}, (pl_vec3){0}, PL_QUAT_IDENTITY);
  assert_true(angle(pl_tumble_at(&t, 1e9, NULL), PL_QUAT_IDENTITY) == 0.0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_reference),      cmocka_unit_test(test_random_bodies),
      cmocka_unit_test(test_special_bodies), cmocka_unit_test(test_symmetric),
      cmocka_unit_test(test_turns_over),     cmocka_unit_test(test_separatrix),
      cmocka_unit_test(test_thirty_years),   cmocka_unit_test(test_errors),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
