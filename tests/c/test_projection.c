/* Projections: there and back, known places, and errors. */
#include "harness.h"

#include <math.h>
#include <string.h>

#include "random.h"
#include "terrain/projection.h"

static const double DEGREE = PL_PI / 180.0, RADIUS_M = 1737400.0;

static pl_projection make(pl_projection_kind kind, double lon_deg, double lat_deg) {
  pl_projection p = {.kind = kind,
                     .lon0_rad = lon_deg * DEGREE,
                     .lat0_rad = lat_deg * DEGREE,
                     .radius_m = RADIUS_M};
  assert_int_equal(pl_projection_init(&p), PL_OK);
  return p;
}

static pl_vec3 at(double lon_deg, double lat_deg) {
  const double lon = lon_deg * DEGREE, lat = lat_deg * DEGREE;
  return (pl_vec3){cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)};
}

static void assert_place(const pl_projection *p, pl_vec3 d, double x, double y, double within) {
  double u, v;
  assert_true(pl_projection_forward(p, d, &u, &v));
  assert_true(fabs(u - x) <= within && fabs(v - y) <= within);
}

static void test_there_and_back(void **state) {
  (void)state;
  test_random random = {.seed = 46};
  pl_projection all[6] = {make(PL_PROJECTION_CYLINDRICAL, 0.0, 0.0),
                          make(PL_PROJECTION_CYLINDRICAL, 0.0, 0.0),
                          make(PL_PROJECTION_STEREOGRAPHIC, 30.0, 90.0),
                          make(PL_PROJECTION_STEREOGRAPHIC, -120.0, -90.0),
                          make(PL_PROJECTION_STEREOGRAPHIC, 12.0, 34.0),
                          make(PL_PROJECTION_ORTHOGRAPHIC, 179.0, -70.0)};
  all[1].axis_ratio = 0.9;
  for (int i = 0; i < PL_DRAWS(20000, 500); i++) {
    const pl_vec3 d = random_direction(&random);
    const double length = random_scale(&random, 1e-6, 1e9);
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
      double x, y;
      if (!pl_projection_forward(&all[k], pl_vec3_scale(d, length), &x, &y)) {
        assert_int_equal(all[k].kind, PL_PROJECTION_ORTHOGRAPHIC);
        assert_true(pl_vec3_dot(d, all[k].up) <= 1e-12);
        continue;
      }
      const pl_vec3 back = pl_projection_inverse(&all[k], x, y);
      /* Rounding is magnified at the edge of an orthographic map, and opposite to the centre of a
       * stereographic one. */
      const double up = pl_vec3_dot(d, all[k].up);
      const double by = all[k].kind == PL_PROJECTION_ORTHOGRAPHIC    ? up
                        : all[k].kind == PL_PROJECTION_STEREOGRAPHIC ? 1.0 + up
                                                                     : 1.0;
      assert_true(pl_vec3_norm(pl_vec3_sub(back, d)) < 4e-15 / fmax(by, 1e-8));
      assert_true(fabs(pl_vec3_norm(back) - 1.0) < 4e-16);
    }
  }
}

/* Snyder 1987, eq. 21-5 to 21-8: rho = 2 R tan(pi/4 - lat/2) on the north pole's map, with x
 * eastwards and y northwards along the central meridian. */
static void test_polar_stereographic(void **state) {
  (void)state;
  const pl_projection north = make(PL_PROJECTION_STEREOGRAPHIC, 10.0, 90.0);
  const pl_projection south = make(PL_PROJECTION_STEREOGRAPHIC, 10.0, -90.0);
  const double rho = 2.0 * RADIUS_M * tan(2.5 * DEGREE);
  assert_place(&north, at(10.0, 85.0), 0.0, -rho, 1e-6);
  assert_place(&north, at(100.0, 85.0), rho, 0.0, 1e-6);
  assert_place(&south, at(10.0, -85.0), 0.0, rho, 1e-6);
  assert_place(&south, at(100.0, -85.0), rho, 0.0, 1e-6);
  assert_place(&north, (pl_vec3){0.0, 0.0, 1.0}, 0.0, 0.0, 0.0);
  assert_place(&south, (pl_vec3){0.0, 0.0, -3.0}, 0.0, 0.0, 0.0);
  double x, y;
  assert_false(pl_projection_forward(&north, (pl_vec3){0.0, 0.0, -1.0}, &x, &y));
  pl_projection true_at_70 = north; /* a map that is true to scale at latitude 70 */
  true_at_70.scale = 0.5 * (1.0 + sin(70.0 * DEGREE));
  assert_int_equal(pl_projection_init(&true_at_70), PL_OK);
  const double step = 1e-6;
  double next;
  assert_true(pl_projection_forward(&true_at_70, at(100.0, 70.0), &x, &y));
  assert_true(pl_projection_forward(&true_at_70, at(100.0, 70.0 - step), &next, &y));
  assert_true(fabs((next - x) / (RADIUS_M * step * DEGREE) - 1.0) < 1e-6);
}

static void test_known_places(void **state) {
  (void)state;
  const pl_projection plane = make(PL_PROJECTION_CYLINDRICAL, 0.0, 0.0);
  assert_place(&plane, at(-170.0, 35.0), -170.0 * DEGREE, 35.0 * DEGREE, 1e-14);
  assert_place(&plane, (pl_vec3){0.0, 0.0, 2.0}, 0.0, 0.5 * PL_PI, 0.0);
  const pl_vec3 beyond = pl_projection_inverse(&plane, 20.0 * DEGREE, 95.0 * DEGREE);
  assert_true(pl_vec3_norm(pl_vec3_sub(beyond, at(200.0, 85.0))) < 1e-15);
  const pl_projection local = make(PL_PROJECTION_ORTHOGRAPHIC, 3.6, 26.1);
  const double step = 1e-3 * DEGREE; /* 30 m northwards, less eastwards */
  assert_place(&local, at(3.6, 26.101), 0.0, RADIUS_M * sin(step), 1e-7);
  assert_place(&local, at(3.601, 26.1), RADIUS_M * cos(26.1 * DEGREE) * sin(step), 1.0165e-4, 1e-5);
  /* WGS 84 (Hofmann-Wellenhof): latitude from the centre 44.8075766 deg where the geodetic is 45.
   */
  pl_projection earth = plane;
  earth.axis_ratio = 1.0 - 1.0 / 298.257223563;
  assert_int_equal(pl_projection_init(&earth), PL_OK);
  assert_place(&earth, at(7.0, 44.80757678), 7.0 * DEGREE, 45.0 * DEGREE, 1e-10);
}

static void test_errors(void **state) {
  (void)state;
  pl_projection_kind kind;
  assert_int_equal(pl_projection_find("orthographic", &kind), PL_OK);
  assert_int_equal(kind, PL_PROJECTION_ORTHOGRAPHIC);
  assert_int_equal(pl_projection_find("mercator", &kind), PL_E_ARGUMENT);
  assert_non_null(strstr(pl_error_text(), "mercator"));
  assert_non_null(strstr(pl_error_text(), "cylindrical, stereographic, orthographic"));
  const pl_projection bad[] = {
      {.kind = PL_PROJECTION_CYLINDRICAL, .axis_ratio = -1.0},
      {.kind = PL_PROJECTION_STEREOGRAPHIC, .radius_m = 0.0},
      {.kind = PL_PROJECTION_STEREOGRAPHIC, .radius_m = 1.0, .scale = NAN},
      {.kind = PL_PROJECTION_ORTHOGRAPHIC, .radius_m = 1.0, .lat0_rad = 2.0},
      {.kind = PL_PROJECTION_ORTHOGRAPHIC, .radius_m = 1.0, .lon0_rad = INFINITY},
  };
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    pl_projection p = bad[i];
    assert_int_equal(pl_projection_init(&p), PL_E_RANGE);
  }
  pl_projection none = {.kind = PL_PROJECTION_COUNT};
  assert_int_equal(pl_projection_init(&none), PL_E_ARGUMENT);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_there_and_back),
      cmocka_unit_test(test_polar_stereographic),
      cmocka_unit_test(test_known_places),
      cmocka_unit_test(test_errors),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
