/* Body orientation against the IAU series, and attitudes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "orbit/attitude.h"
#include "orbit/orientation.h"

#define DEGREE (180.0 / PL_PI)

static const pl_celestial *body(const char *name) {
  const pl_celestial *found = NULL;
  assert_int_equal(pl_celestial_require(name, &found), PL_OK);
  return found;
}
static double turned(double degrees) { return degrees - 360.0 * floor(degrees / 360.0); }
static double angle_between(pl_quat a, pl_quat b) {
  const pl_quat d = pl_quat_mul(pl_quat_conjugate(a), b);
  return 2.0 * atan2(sqrt(d.x * d.x + d.y * d.y + d.z * d.z), fabs(d.w));
}

/* The series at J2000, summed by hand with 40 digits; degrees. */
static void test_epoch(void **state) {
  (void)state;
  static const struct {
    const char *name;
    double ra, dec, w;
  } table[] = {
      {"moon", 266.857733444955, 65.641102747845, 41.195263980745},
      {"europa", 268.03980652405, 64.961246022088, 36.058732960586},
      {"phobos", 318.00280838105, 53.942651587447, -1.0},
      {"mars", 317.68143, 52.88650, 176.630},
      {"earth", 0.0, 90.0, 190.147},
  };
  for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
    const pl_pole pole = pl_celestial_pole(body(table[i].name), PL_J2000_JD, 0.0);
    assert_true(fabs(turned(pole.ra_rad * DEGREE) - table[i].ra) < 1e-11);
    assert_true(fabs(pole.dec_rad * DEGREE - table[i].dec) < 1e-11);
    if (table[i].w >= 0.0)
      assert_true(fabs(turned(pole.w_rad * DEGREE) - table[i].w) < 1e-11);
  }
}

/* Phases after tens of thousands of days: exact rational arithmetic on the same doubles. */
static void test_phase_in_parts(void **state) {
  (void)state;
  static const struct {
    const char *name;
    double day, fraction, w;
  } table[] = {
      {"earth", 10000, 0.25, 56.62840587474227},
      {"earth", -20000.5, 0.123456789, 141.75031420298836},
      {"jupiter", 10000, 0.25, -17.416000000554817},
      {"jupiter", -20000.5, 0.123456789, -82.84442072998641},
  };
  for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
    const pl_pole pole =
        pl_celestial_pole(body(table[i].name), PL_J2000_JD + table[i].day, table[i].fraction);
    assert_true(fabs(remainder(pole.w_rad * DEGREE - table[i].w, 360.0)) < 4e-13);
  }
}

/* The split of the date does not matter. */
static void test_split(void **state) {
  (void)state;
  size_t count = 0;
  const pl_celestial *bodies = pl_celestial_table(&count);
  assert_int_equal(count, 12);
  for (size_t i = 0; i < count; i++) {
    const pl_quat a = pl_celestial_orientation(&bodies[i], 2461000.5, 0.75);
    assert_true(angle_between(a, pl_celestial_orientation(&bodies[i], 2461001.0, 0.25)) < 1e-12);
    assert_true(angle_between(a, pl_celestial_orientation(&bodies[i], 2461000.5 - 30.0, 30.75)) <
                1e-12);
  }
}

/* z of the body is the pole, and it turns about it by W's rate, in W's direction. */
static void test_axes_and_rate(void **state) {
  (void)state;
  size_t count = 0;
  const pl_celestial *bodies = pl_celestial_table(&count);
  for (size_t i = 0; i < count; i++) {
    const pl_pole pole = pl_celestial_pole(&bodies[i], 2461000.5, 0.3);
    const pl_quat q = pl_celestial_orientation(&bodies[i], 2461000.5, 0.3);
    const pl_vec3 north = {cos(pole.dec_rad) * cos(pole.ra_rad),
                           cos(pole.dec_rad) * sin(pole.ra_rad), sin(pole.dec_rad)};
    assert_true(pl_vec3_norm(pl_vec3_sub(pl_quat_rotate(q, pl_vec3_make(0, 0, 1)), north)) < 1e-15);
    const pl_vec3 node = {-sin(pole.ra_rad), cos(pole.ra_rad), 0.0};
    const pl_quat equator = pl_celestial_equator(&bodies[i], 2461000.5, 0.3);
    assert_true(pl_vec3_norm(pl_vec3_sub(pl_quat_rotate(equator, pl_vec3_make(1, 0, 0)), node)) <
                1e-15);
    const double step_days = 1e-3;
    const pl_quat later = pl_celestial_orientation(&bodies[i], 2461000.5, 0.3 + step_days);
    const pl_vec3 x = pl_quat_rotate_inverse(q, pl_quat_rotate(later, pl_vec3_make(1, 0, 0)));
    const double rate = atan2(x.y, x.x) * DEGREE / step_days;
    /* 2 %: the forced libration of Phobos, 1.143 deg at its orbital rate */
    assert_true(fabs(rate / bodies[i].rotation.w_deg[1] - 1.0) < 2.1e-2);
  }
}

/* The Moon keeps its face to the Earth: within 8 deg of libration over a month of 2026. The Moon's
 * direction is the low-precision series of Vallado (0.3 deg). */
static pl_vec3 moon_direction(double days) {
  const double t = days / 36525.0, r = PL_PI / 180.0;
  const double lambda =
      218.32 + 481267.8813 * t + 6.29 * sin(r * (134.9 + 477198.85 * t)) -
      1.27 * sin(r * (259.2 - 413335.38 * t)) + 0.66 * sin(r * (235.7 + 890534.23 * t)) +
      0.21 * sin(r * (269.9 + 954397.70 * t)) - 0.19 * sin(r * (357.5 + 35999.05 * t)) -
      0.11 * sin(r * (186.6 + 966404.05 * t)) - 1.397 * t; /* of date to J2000 */
  const double beta =
      5.13 * sin(r * (93.3 + 483202.03 * t)) + 0.28 * sin(r * (228.2 + 960400.87 * t)) -
      0.28 * sin(r * (318.3 + 6003.18 * t)) - 0.17 * sin(r * (217.6 - 407332.20 * t));
  const double eps = 23.439291 * r, l = lambda * r, b = beta * r;
  const pl_vec3 e = {cos(b) * cos(l), cos(b) * sin(l), sin(b)};
  return pl_vec3_make(e.x, e.y * cos(eps) - e.z * sin(eps), e.y * sin(eps) + e.z * cos(eps));
}
static void test_moon_faces_earth(void **state) {
  (void)state;
  for (int day = 0; day < 60; day++) {
    const double days = 9500.0 + day;
    const pl_quat q = pl_celestial_orientation(body("moon"), PL_J2000_JD + 9500.0, day);
    const pl_vec3 to_earth = pl_vec3_scale(moon_direction(days), -1.0);
    const pl_vec3 seen = pl_quat_rotate_inverse(q, to_earth);
    assert_true(fabs(atan2(seen.y, seen.x) * DEGREE) < 8.5);
    assert_true(fabs(asin(seen.z) * DEGREE) < 7.5);
  }
}

static void test_unknown_body(void **state) {
  (void)state;
  const pl_celestial *found = NULL;
  assert_int_equal(pl_celestial_require("erth", &found), PL_E_ARGUMENT);
  assert_non_null(strstr(pl_error_text(), "'erth'"));
  assert_non_null(strstr(pl_error_text(), "sun, mercury"));
  assert_non_null(strstr(pl_error_text(), "neptune"));
  assert_null(pl_celestial_find("Earth"));
}

/* 30 years at one turn a minute end on the phase that exact arithmetic gives. */
static void test_long_spin(void **state) {
  (void)state;
  const double rate = 2.0 * PL_PI / 60.0, t = 946728001.0;
  const pl_vec3 axis = {0, 0, 1};
  const pl_quat q = pl_attitude_spin(PL_QUAT_IDENTITY, axis, rate, t);
  assert_true(fabs(remainder(2.0 * atan2(q.z, q.w) - 0.10471974687547161, 2.0 * PL_PI)) < 2e-15);
  /* and about its own axis: q(t) = q0 rot(axis) */
  const pl_quat tilt = pl_quat_axis_angle(pl_vec3_make(1, 0, 0), 0.7);
  const pl_quat at = pl_attitude_spin(tilt, axis, 0.25, 2.0);
  const pl_vec3 z = pl_quat_rotate(at, axis);
  assert_true(pl_vec3_norm(pl_vec3_sub(z, pl_quat_rotate(tilt, axis))) < 1e-15);
  assert_true(angle_between(at, pl_quat_mul(tilt, pl_quat_axis_angle(axis, 0.5))) < 1e-15);
}

static void test_lvlh(void **state) {
  (void)state;
  const pl_state circular = {{0, 7e6, 0}, {-6e3, 100, 4e3}};
  pl_quat q;
  assert_int_equal(pl_attitude_lvlh(&circular, &q), PL_OK);
  const pl_vec3 x = pl_quat_rotate(q, pl_vec3_make(1, 0, 0));
  const pl_vec3 y = pl_quat_rotate(q, pl_vec3_make(0, 1, 0));
  const pl_vec3 z = pl_quat_rotate(q, pl_vec3_make(0, 0, 1));
  const pl_vec3 h = pl_vec3_unit(pl_vec3_cross(circular.r_m, circular.v_m_s));
  assert_true(pl_vec3_norm(pl_vec3_sub(z, pl_vec3_make(0, -1, 0))) < 1e-15);
  assert_true(pl_vec3_norm(pl_vec3_add(y, h)) < 1e-15);
  assert_true(pl_vec3_dot(x, pl_vec3_unit(circular.v_m_s)) > 0.999);
  /* no motion, and radial motion over the pole: still a frame, z to the centre */
  const pl_state still[] = {{{0, 0, 5}, {0, 0, 0}}, {{0, 0, 5}, {0, 0, 1}}, {{3, 0, 0}, {0, 0, 0}}};
  for (size_t i = 0; i < 3; i++) {
    assert_int_equal(pl_attitude_lvlh(&still[i], &q), PL_OK);
    const pl_vec3 down = pl_quat_rotate(q, pl_vec3_make(0, 0, 1));
    assert_true(pl_vec3_norm(pl_vec3_add(down, pl_vec3_unit(still[i].r_m))) < 1e-15);
  }
  const pl_state centre = {{0, 0, 0}, {1, 0, 0}};
  assert_int_equal(pl_attitude_lvlh(&centre, &q), PL_E_RANGE);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_epoch),
      cmocka_unit_test(test_phase_in_parts),
      cmocka_unit_test(test_split),
      cmocka_unit_test(test_axes_and_rate),
      cmocka_unit_test(test_moon_faces_earth),
      cmocka_unit_test(test_unknown_body),
      cmocka_unit_test(test_long_spin),
      cmocka_unit_test(test_lvlh),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
