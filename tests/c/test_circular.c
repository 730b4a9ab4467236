/* The scaled circle: places by hand from the paper's listing, rate, phase far away. */
#include "harness.h"

#include <string.h>

#include "orbit/circular.h"
#include "random.h"

static double distance(pl_vec3 a, pl_vec3 b) { return pl_vec3_norm(pl_vec3_sub(a, b)); }

static pl_propagator *make(pl_circle circle) {
  pl_propagator *out = NULL;
  assert_int_equal(pl_circular_create(&circle, &out), PL_OK);
  return out;
}

/* 408 km over a body of 6378 km: scale 1.06396989; v_step 0.01 and steps of 60 s. */
static void test_listing(void **state) {
  (void)state;
  const double r = 1.06396989 * 6378e3;
  const pl_quat q = pl_quat_axis_angle(pl_vec3_make(1, 0, 0), 0.5 * PL_PI);
  pl_propagator *path = make((pl_circle){{r, r, r}, q, 0.25, 0.01 / 60.0});
  for (int step = -3; step < 200; step++) {
    const double t = 60.0 * step, u = 2.0 * PL_PI * (0.25 + 0.01 * step);
    pl_state s;
    assert_int_equal(pl_propagator_states(path, 1, &t, &s), PL_OK);
    assert_true(distance(s.r_m, pl_vec3_make(r * cos(u), 0.0, r * sin(u))) < 1e-12 * r);
    const double v = r * 2.0 * PL_PI * 0.01 / 60.0;
    assert_true(distance(s.v_m_s, pl_vec3_make(-v * sin(u), 0.0, v * cos(u))) < 1e-12 * v);
  }
  pl_propagator_destroy(path);
}

/* An ellipse about its middle: on it at any time, and a whole number of turns is no motion. */
static void test_ellipse(void **state) {
  (void)state;
  test_random random = {.seed = 8};
  for (int n = 0; n < 2000; n++) {
    const pl_vec3 radii = {random_scale(&random, 1, 1e8), random_scale(&random, 1, 1e8), 3.0};
    const pl_quat q = random_rotation(&random);
    const double rate = ldexp(1.0 + random_below(&random, 1000), -20);
    pl_propagator *path = make((pl_circle){radii, q, random_range(&random, -9, 9), rate});
    const double whole = ldexp(1.0, 20); /* rate * whole is a whole number */
    const double t[3] = {random_range(&random, -1e9, 1e9), 0.0, 950.0 * whole};
    pl_state s[3];
    assert_int_equal(pl_propagator_states(path, 3, t, s), PL_OK);
    const pl_vec3 at = pl_quat_rotate_inverse(q, s[0].r_m);
    const double x = at.x / radii.x, y = at.y / radii.y;
    const double size = fmax(radii.x, radii.y);
    assert_true(fabs(x * x + y * y - 1.0) < 1e-14 * size / fmin(radii.x, radii.y));
    assert_true(fabs(at.z) < 1e-15 * size);
    assert_memory_equal(&s[1], &s[2], sizeof s[1]);
    pl_propagator_destroy(path);
  }
}

static void test_errors(void **state) {
  (void)state;
  const pl_circle good = {{1, 1, 1}, PL_QUAT_IDENTITY, 0.0, 1.0};
  pl_propagator *path = NULL;
  pl_circle bad = good;
  bad.radii_m.y = 0.0;
  assert_int_equal(pl_circular_create(&bad, &path), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "radii_m is (1, 0, 1)"));
  bad = good;
  bad.rate_rev_s = INFINITY;
  assert_int_equal(pl_circular_create(&bad, &path), PL_E_RANGE);
  bad = good;
  bad.start_rev = NAN;
  assert_int_equal(pl_circular_create(&bad, &path), PL_E_RANGE);
  bad = good;
  bad.q = (pl_quat){0};
  assert_int_equal(pl_circular_create(&bad, &path), PL_E_RANGE);
  assert_null(path);
  bad = good;
  bad.rate_rev_s = 1e300;
  path = make(bad);
  const double t = 1e9;
  pl_state s;
  assert_int_equal(pl_propagator_states(path, 1, &t, &s), PL_E_RANGE);
  pl_propagator_destroy(path);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_listing),
      cmocka_unit_test(test_ellipse),
      cmocka_unit_test(test_errors),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
