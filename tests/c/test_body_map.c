/* Coordinates and footprints on bodies: against finite differences, over the date line and the
 * poles; and graphs at points of bodies. */
#include "graphs.h"

#include <math.h>

#include "geom/ellipsoid.h"
#include "random.h"
#include "shade/body_map.h"

static const pl_vec3 RADII = {6378137.0, 6378137.0, 6356752.0};

/* The point of the ellipsoid in a direction from its centre. */
static pl_vec3 surface_at(double lon, double lat) {
  const pl_vec3 d = {cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)};
  const pl_vec3 scaled = {d.x / RADII.x, d.y / RADII.y, d.z / RADII.z};
  return pl_vec3_scale(d, 1.0 / pl_vec3_norm(scaled));
}

static void uv_of(pl_vec3 point, double center, float uv[2]) {
  const pl_vec3 none = {0.0, 0.0, 0.0};
  float a[2], b[2];
  pl_body_map_uv(point, center, none, none, uv, a, b);
}

static void test_places(void **state) {
  (void)state;
  float uv[2];
  uv_of(surface_at(0.0, 0.0), 0.0, uv);
  assert_true(uv[0] == 0.5f && uv[1] == 0.5f);
  uv_of(surface_at(0.5 * PL_PI, 0.25 * PL_PI), 0.0, uv); /* a quarter turn east, 45 degrees north */
  assert_true(fabsf(uv[0] - 0.75f) < 1e-6f && fabsf(uv[1] - 0.25f) < 1e-6f);
  uv_of(surface_at(0.5 * PL_PI, 0.0), 0.5 * PL_PI, uv);
  assert_true(fabsf(uv[0] - 0.5f) < 1e-6f);
  uv_of((pl_vec3){0.0, 0.0, RADII.z}, 0.0, uv);
  assert_true(uv[1] == 0.0f && uv[0] >= 0.0f && uv[0] < 1.0f);
}

/* The footprint is the difference between the coordinates of its ends, modulo a turn. */
static void test_footprints_are_differences(void **state) {
  (void)state;
  test_random random = {5, 0};
  double worst = 0.0;
  for (int i = 0; i < 2000; i++) {
    /* A third lies on the date line. */
    const double lon = i % 3 == 0 ? PL_PI : random_range(&random, -PL_PI, PL_PI);
    const double lat = 0.49 * random_range(&random, -PL_PI, PL_PI);
    const pl_vec3 p = surface_at(lon, lat);
    const pl_vec3 step = {random_range(&random, -100.0, 100.0),
                          random_range(&random, -100.0, 100.0),
                          random_range(&random, -100.0, 100.0)};
    float uv[2], a[2], b[2];
    double from[2], to[2];
    pl_body_map_uv(p, 0.3, step, (pl_vec3){0.0, 0.0, 0.0}, uv, a, b);
    pl_ellipsoid_lon_lat(pl_vec3_madd(p, -0.5, step), &from[0], &from[1]);
    pl_ellipsoid_lon_lat(pl_vec3_madd(p, 0.5, step), &to[0], &to[1]);
    const double du = remainder(to[0] - from[0], 2.0 * PL_PI) / (2.0 * PL_PI);
    const double dv = -(to[1] - from[1]) / PL_PI;
    worst = fmax(worst, fabs((double)a[0] - du) / (1e-9 + fabs(du)));
    worst = fmax(worst, fabs((double)a[1] - dv) / (1e-9 + fabs(dv)));
    assert_true(b[0] == 0.0f && b[1] == 0.0f);
  }
  print_message("worst relative error of footprints: %.2g\n", worst);
  assert_true(worst < 1e-4);
}

/* Stretched, a place has the latitude of the ellipsoid's normal, and its footprint goes along. */
static void test_geodetic_latitudes(void **state) {
  (void)state;
  test_random random = {6, 0};
  double worst = 0.0, worst_step = 0.0;
  for (int i = 0; i < 2000; i++) {
    const double pole = random_range(&random, 0.5, 1.5);
    const pl_vec3 radii = {1e6, 1e6, pole * 1e6};
    const double oblate = pl_body_map_oblate(radii);
    const double lon = random_range(&random, -3.0, 3.0), t = random_range(&random, -1.5, 1.5);
    float uv[2], a[2], b[2];
    double lat[2];
    pl_vec3 p[2];
    for (int k = 0; k < 2; k++) { /* two places on a meridian, 40 m apart or so */
      const double at = t + 4e-5 * (k - 0.5);
      p[k] =
          (pl_vec3){radii.x * cos(at) * cos(lon), radii.y * cos(at) * sin(lon), radii.z * sin(at)};
      const pl_vec3 n = pl_ellipsoid_normal(radii, p[k]);
      lat[k] = asin(n.z);
    }
    const pl_vec3 middle = pl_vec3_scale(pl_vec3_add(p[0], p[1]), 0.5);
    const pl_vec3 step = pl_vec3_sub(p[1], p[0]);
    pl_body_map_uv(pl_body_map_stretch(middle, oblate), 0.0, (pl_vec3){0.0, 0.0, 0.0},
                   pl_body_map_stretch(step, oblate), uv, a, b);
    worst = fmax(worst, fabs(0.5 - (double)uv[1] - 0.5 * (lat[0] + lat[1]) / PL_PI));
    const double expected = -(lat[1] - lat[0]) / PL_PI;
    worst_step = fmax(worst_step, fabs((double)b[1] - expected) / fabs(expected));
    assert_true(fabs((double)uv[0] - 0.5 - lon / (2.0 * PL_PI)) < 1e-6);
  }
  print_message("worst error of geodetic latitudes: %.2g turns, of footprints: %.2g\n", worst,
                worst_step);
  assert_true(worst < 1e-6 && worst_step < 1e-4);
}

static void test_poles_are_finite(void **state) {
  (void)state;
  float uv[2], a[2], b[2];
  for (int side = -1; side <= 1; side += 2) {
    const pl_vec3 pole = {0.0, 0.0, side * RADII.z};
    pl_body_map_uv(pole, 0.0, (pl_vec3){1e3, 0, 0}, (pl_vec3){0, 1e3, 0}, uv, a, b);
    assert_true(isfinite(a[0]) && isfinite(a[1]) && isfinite(b[0]) && isfinite(b[1]));
    /* A step of 1 km over the pole is so much of latitude, whichever way. */
    assert_true(fabsf(a[1]) + fabsf(b[1]) > 0.0f);
  }
}

/* --- nodes ------------------------------------------------------------------------------------ */

static pl_graph_point point_at(double lon, double lat, const pl_mat3 *axes, double width_m) {
  const pl_vec3 place = surface_at(lon, lat);
  const pl_vec3 n = pl_ellipsoid_normal(RADII, place);
  const pl_vec3 east = {-sin(lon), cos(lon), 0.0}, north = pl_vec3_cross(n, east);
  return (pl_graph_point){
      .object = pl_vec3_to_float(place),
      .world = pl_vec3_to_float(pl_mat3_mul_vec(*axes, place)),
      .t = pl_vec3_to_float(pl_mat3_mul_vec(*axes, east)),
      .b = pl_vec3_to_float(pl_mat3_mul_vec(*axes, north)),
      .n = pl_vec3_to_float(pl_mat3_mul_vec(*axes, n)),
      .ng = pl_vec3_to_float(pl_mat3_mul_vec(*axes, n)),
      .view = pl_vec3_to_float(pl_mat3_mul_vec(*axes, n)),
      .radius = (float)(width_m / sqrt(PL_PI)),
      .scale = 1.0f,
      .bumps = true,
      .body = axes,
      .place = place,
      .across = pl_vec3_scale(east, width_m),
      .along = pl_vec3_scale(north, width_m),
  };
}

/* Body axes that are not the root's. */
static const pl_mat3 AXES = {{{0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}}};

static void coordinates_at(const pl_graph_point *point, const char *space, pl_value out) {
  static test_graph g;
  memset(&g, 0, sizeof g);
  const size_t node = graph_add(&g, "coordinates");
  graph_choose(&g, node, "space", space);
  graph_value_at(g, node, 0, point, out);
}

static void test_coordinates(void **state) {
  (void)state;
  const double deg = PL_PI / 180.0;
  const pl_graph_point point = point_at(120.0 * deg, -30.0 * deg, &AXES, 1e4);
  pl_value v;
  coordinates_at(&point, "lon_lat_deg", v);
  assert_true(fabsf(v[0] - 120.0f) < 1e-4f && fabsf(v[1] + 30.0f) < 1e-4f && v[2] == 0.0f);
  /* 10 km are this much of a turn east and of half a turn north; the circle has their product. */
  const double rho = hypot(point.place.x, point.place.y), r = pl_vec3_norm(point.place);
  const double area = 1e4 / (2.0 * PL_PI * rho) * 360.0 * (1e4 / (PL_PI * r) * 180.0);
  assert_true(fabs((double)v[3] / sqrt(area / PL_PI) - 1.0) < 0.01);
  coordinates_at(&point, "uv", v);
  assert_true(fabsf(v[0] - (0.5f + 120.0f / 360.0f)) < 1e-6f &&
              fabsf(v[1] - 120.0f / 180.0f) < 1e-6f);
  coordinates_at(&point, "object", v);
  assert_true(v[0] == (float)point.place.x && v[2] == (float)point.place.z && v[3] == point.radius);
}

/* At a pole the map's whole width is in the footprint, and no more. */
static void test_coordinates_at_a_pole(void **state) {
  (void)state;
  const pl_graph_point point = point_at(0.0, 0.5 * PL_PI, &AXES, 1e4);
  pl_value v;
  coordinates_at(&point, "lon_lat_deg", v);
  const double area = 360.0 * (1e4 / (PL_PI * RADII.z) * 180.0);
  assert_true(fabsf(v[1] - 90.0f) < 1e-4f);
  assert_true(fabs((double)v[3] / sqrt(area / PL_PI) - 1.0) < 0.01);
}

/* A height of sin(k x) along the body's x has the slope k cos(k x) there, wherever the body's axes
 * point and though x in float is known to half a metre alone. */
static void test_bump_on_a_body(void **state) {
  (void)state;
  static test_graph g;
  memset(&g, 0, sizeof g);
  const float k = 1e-4f;
  const size_t where = graph_add(&g, "coordinates"), dot = graph_add(&g, "vector_math"),
               wave = graph_add(&g, "math"), bump = graph_add(&g, "bump"),
               skin = graph_add(&g, "lambert");
  graph_choose(&g, dot, "function", "dot");
  graph_choose(&g, wave, "function", "sine");
  graph_link(&g, dot, "a", where, 0);
  graph_set(&g, dot, "b", k, 0.0f, 0.0f);
  graph_link(&g, wave, "a", dot, 1);
  graph_link(&g, bump, "height", wave, 0);
  graph_set(&g, bump, "distance_m", 1e3f, 1e3f, 1e3f);
  graph_link(&g, skin, "normal", bump, 0);
  pl_graph *graph;
  assert_int_equal(graph_make(&g, &graph), PL_OK);
  double worst = 0.0;
  for (int i = 0; i < 200; i++) {
    const double lon = 0.5 * PL_PI + 0.001 * (i - 100);
    const pl_graph_point point = point_at(lon, 0.2, &AXES, i % 2 ? 100.0 : 10.0);
    pl_surface surface = {.t = point.t, .b = point.b, .n = point.n, .ng = point.n};
    pl_graph_surface(graph, &point, NULL, &surface);
    const double x = point.place.x, slope = 1e3 * (double)k * cos((double)k * x);
    /* The gradient's part in the tangent plane. */
    const pl_vec3 n = pl_ellipsoid_normal(RADII, point.place), e = {1.0, 0.0, 0.0};
    const pl_vec3 tilt = pl_vec3_madd(e, -pl_vec3_dot(e, n), n);
    const pl_vec3 expected = pl_mat3_mul_vec(AXES, pl_vec3_unit(pl_vec3_madd(n, -slope, tilt)));
    const pl_vec3 got = pl_vec3f_to_double(surface.n);
    worst = fmax(worst, pl_vec3_norm(pl_vec3_sub(got, expected)));
  }
  print_message("worst error of bumped normals on a planet: %.2g\n", worst);
  assert_true(worst < 0.02);
  pl_graph_destroy(graph);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_places),
      cmocka_unit_test(test_footprints_are_differences),
      cmocka_unit_test(test_geodetic_latitudes),
      cmocka_unit_test(test_poles_are_finite),
      cmocka_unit_test(test_coordinates),
      cmocka_unit_test(test_coordinates_at_a_pole),
      cmocka_unit_test(test_bump_on_a_body),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
