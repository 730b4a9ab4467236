/* Where lines are inside of bounding shapes: closed forms, points on random lines against the
 * inequalities that define the shapes, and origins far away. */
#include "harness.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "geom/bound.h"

static bool inside(const pl_bound *bound, const double s[3], pl_vec3 p, double grow) {
  if (bound == &pl_bound_box)
    return fabs(p.x) <= 0.5 * s[0] * grow && fabs(p.y) <= 0.5 * s[1] * grow &&
           fabs(p.z) <= 0.5 * s[2] * grow;
  if (bound == &pl_bound_ellipsoid)
    return p.x * p.x / (s[0] * s[0]) + p.y * p.y / (s[1] * s[1]) + p.z * p.z / (s[2] * s[2]) <=
           grow * grow;
  const double radius = s[0] + (s[1] - s[0]) * p.z / s[2];
  return p.z >= (1.0 - grow) * s[2] && p.z <= s[2] * grow &&
         hypot(p.x, p.y) <= radius + (grow - 1.0) * fmax(s[0], s[1]);
}

static bool span_of(const pl_bound *bound, const double size[3], pl_vec3 o, pl_vec3 d,
                    double t[2]) {
  const pl_bound_ball ball = pl_bound_sphere(bound, size);
  return pl_bound_span(bound, size, &ball, o, d, t);
}

static pl_vec3 at(pl_vec3 o, double t, pl_vec3 d) { return pl_vec3_madd(o, t, d); }

/* Points of the span are inside, points before and behind it are not; a line without a span has no
 * point inside. */
static void check_line(const pl_bound *bound, const double size[3], pl_vec3 o, pl_vec3 d,
                       int *met) {
  double t[2];
  enum { POINTS = 40 };
  const bool found = span_of(bound, size, o, d, t);
  for (int i = 0; i <= POINTS; i++) {
    if (found) {
      const double within = t[0] + (t[1] - t[0]) * (i + 0.5) / (POINTS + 1);
      assert_true(inside(bound, size, at(o, within, d), 1.0 + 1e-9));
      assert_false(inside(bound, size, at(o, t[0] - 0.01 * (i + 1), d), 1.0 - 1e-9));
      assert_false(inside(bound, size, at(o, t[1] + 0.01 * (i + 1), d), 1.0 - 1e-9));
    } else {
      assert_false(inside(bound, size, at(o, 0.5 * (i - POINTS / 2), d), 1.0 - 1e-9));
    }
  }
  *met += found;
}

static const double sizes[][3] = {{2.0, 3.0, 0.7}, {1.0, 0.2, 2.5}, {0.3, 2.0, 4.0}};

static void test_random_lines(void **state) {
  (void)state;
  for (size_t i = 0; i < pl_bound_count; i++)
    for (size_t k = 0; k < 3; k++) {
      int met = 0;
      uint32_t seed = 17;
      for (int n = 0; n < 400; n++) {
        double x[6];
        for (int m = 0; m < 6; m++) {
          seed = seed * 1664525u + 1013904223u;
          x[m] = (double)seed * 0x1p-31 - 1.0;
        }
        const pl_vec3 d = pl_vec3_unit((pl_vec3){x[3], x[4], x[5]});
        check_line(pl_bounds[i], sizes[k], (pl_vec3){2.0 * x[0], 2.0 * x[1], 2.0 * x[2]}, d, &met);
      }
      assert_in_range(met, 40, 390);
    }
}

static void check_near(double found, double expected, double by) {
  if (!(fabs(found - expected) <= by))
    fail_msg("%.15g, not %.15g", found, expected);
}

/* A cone to a point, one that is a cylinder, and lines along the axis, along a side, through the
 * tip and in the plane of an end. */
static void test_cone(void **state) {
  (void)state;
  const double tip[3] = {0.0, 2.0, 4.0}, pipe[3] = {1.5, 1.5, 4.0};
  const pl_vec3 z = {0, 0, 1}, x = {1, 0, 0};
  double t[2];
  assert_true(span_of(&pl_bound_cone, tip, (pl_vec3){0, 0, -3}, z, t));
  check_near(t[0], 3.0, 1e-12);
  check_near(t[1], 7.0, 1e-12);
  assert_true(span_of(&pl_bound_cone, tip, (pl_vec3){-9, 0, 2}, x, t));
  check_near(t[0], 8.0, 1e-12);
  check_near(t[1], 10.0, 1e-12);
  assert_true(span_of(&pl_bound_cone, pipe, (pl_vec3){0.5, 0, -3}, z, t));
  check_near(t[1] - t[0], 4.0, 1e-12);
  assert_false(span_of(&pl_bound_cone, pipe, (pl_vec3){1.6, 0, -3}, z, t));
  assert_false(span_of(&pl_bound_cone, tip, (pl_vec3){-9, 0, 0}, x, t));
  assert_false(span_of(&pl_bound_cone, tip, (pl_vec3){-9, 0, 4}, x, t));
  /* Parallel to its side and 1e-6 m inside, it is there for all but 2e-6 m of the height. */
  const pl_vec3 side = pl_vec3_unit((pl_vec3){2, 0, 4});
  assert_true(span_of(&pl_bound_cone, tip, (pl_vec3){-1e-6, 0, 0}, side, t));
  check_near(t[1] - t[0], sqrt(20.0), 2e-6);
  /* Towards the tip a line does not come out of the other half of the double cone. */
  assert_true(
      span_of(&pl_bound_cone, tip, (pl_vec3){0, 0, 10}, pl_vec3_unit((pl_vec3){0.01, 0, -1}), t));
  assert_true(10.0 - t[1] * cos(atan(0.01)) >= 0.0);
}

static void test_degenerate_lines(void **state) {
  (void)state;
  const double unit[3] = {2.0, 2.0, 2.0}, ball[3] = {1.0, 1.0, 1.0};
  const pl_vec3 x = {1, 0, 0};
  double t[2];
  assert_false(span_of(&pl_bound_box, unit, (pl_vec3){-5, 1.0, 0}, x, t));
  assert_true(span_of(&pl_bound_box, unit, (pl_vec3){-5, 0.999999, 0}, x, t));
  assert_false(span_of(&pl_bound_ellipsoid, ball, (pl_vec3){-5, 1.0, 0}, x, t));
  assert_true(span_of(&pl_bound_ellipsoid, ball, (pl_vec3){0, 0, 0}, x, t));
  check_near(t[0], -1.0, 1e-12);
  check_near(t[1], 1.0, 1e-12);
}

/* A metre seen from 1e9 m: the chord is right to what the origin's coordinates keep. */
static void test_far_origin(void **state) {
  (void)state;
  const double ball[3] = {1.0, 1.0, 1.0};
  const pl_vec3 d = pl_vec3_unit((pl_vec3){1, 2, -2}), across = pl_vec3_unit((pl_vec3){0, 1, 1});
  double t[2];
  const pl_vec3 o = pl_vec3_madd(pl_vec3_scale(across, 0.6), -1e9, d);
  assert_true(span_of(&pl_bound_ellipsoid, ball, o, d, t));
  check_near(t[1] - t[0], 1.6, 2e-6);
}

static void test_sphere_and_support(void **state) {
  (void)state;
  const double s[3] = {0.5, 2.0, 4.0};
  const pl_bound_ball ball = pl_bound_sphere(&pl_bound_cone, s);
  check_near(ball.center.z, 2.0, 1e-12);
  check_near(ball.radius_m, sqrt(4.0 + 4.0 + 4.0), 1e-12);
  const pl_vec3 d = pl_vec3_unit((pl_vec3){3, 0, 4});
  check_near(pl_bound_cone.support(s, d), 2.0 * 0.6 + 4.0 * 0.8, 1e-12);
  check_near(pl_bound_box.support(s, d), 0.5 * (0.5 * 0.6 + 4.0 * 0.8), 1e-12);
  check_near(pl_bound_ellipsoid.support(s, d), hypot(0.5 * 0.6, 4.0 * 0.8), 1e-12);
}

static void test_table(void **state) {
  (void)state;
  for (size_t i = 0; i < pl_bound_count; i++) {
    assert_true(strlen(pl_bounds[i]->doc) > 0);
    for (size_t k = 0; k < i; k++)
      assert_string_not_equal(pl_bounds[i]->name, pl_bounds[k]->name);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_random_lines),       cmocka_unit_test(test_cone),
      cmocka_unit_test(test_degenerate_lines),   cmocka_unit_test(test_far_origin),
      cmocka_unit_test(test_sphere_and_support), cmocka_unit_test(test_table),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
