/* Rays against ellipsoids: the reference values of planet-scale intersection, and invariants. */
#include "harness.h"

#include <stdio.h>

#include "geom/ellipsoid.h"
#include "random.h"

/* A ray along +z from (b, 0, -distance). */
static bool shoot(double radius, double distance, double b, double *t) {
  return pl_ellipsoid_intersect((pl_vec3){radius, radius, radius}, (pl_vec3){b, 0, -distance},
                                (pl_vec3){0, 0, 1}, 0.0, t);
}

/* t = D - sqrt((R - b)(R + b)), to 30 digits in Python's decimal. One ulp of t is 6e-5 m. */
static void test_reference(void **state) {
  (void)state;
  double t;
  assert_true(shoot(6371000.0, 4e11, 0.0, &t));
  assert_true(fabs(t - 399993629000.0) <= 1.3e-4);
  assert_true(shoot(1737400.0, 4e11, 1e6, &t));
  assert_true(fabs(t - 399998579240.076579) <= 1.3e-4);
  /* Grazing: dt/db is 56000, and b is known to R * 2^-53 = 1e-9 m after the scaling. */
  assert_true(shoot(6371000.0, 4e11, 6370999.999, &t));
  print_message("grazing at 4e11 m: %.9f, error %.2g m\n", t, t - 399999999887.119532);
  assert_true(fabs(t - 399999999887.119532) <= 3e-4);
  assert_false(shoot(6371000.0, 1.496e11, 6371000.0001, &t));
}

static void test_inside_and_behind(void **state) {
  (void)state;
  double t;
  assert_true(shoot(2.0, 0.0, 0.0, &t)); /* from the centre */
  assert_true(fabs(t - 2.0) < 1e-15);
  assert_true(shoot(2.0, 1.0, 0.0, &t)); /* from inside: the far side */
  assert_true(fabs(t - 3.0) < 1e-15);
  assert_false(shoot(2.0, -3.0, 0.0, &t)); /* behind */
  const pl_vec3 unit = {1, 1, 1}, zero = {0, 0, 0};
  assert_false(pl_ellipsoid_intersect(unit, (pl_vec3){0, 0, -3}, zero, 0.0, &t));
  assert_false(pl_ellipsoid_intersect(unit, (pl_vec3){0, 0, -3}, (pl_vec3){0, 0, NAN}, 0.0, &t));
}

static void test_t_min(void **state) {
  (void)state;
  double t;
  const pl_vec3 r = {1, 1, 1}, o = {0, 0, -3}, d = {0, 0, 1};
  assert_true(pl_ellipsoid_intersect(r, o, d, 2.5, &t));
  assert_true(fabs(t - 4.0) < 1e-15);
  assert_false(pl_ellipsoid_intersect(r, o, d, 4.5, &t));
}

/* How far a point is from the surface, in units of the radii. */
static double level(pl_vec3 r, pl_vec3 p) {
  return pl_vec3_norm((pl_vec3){p.x / r.x, p.y / r.y, p.z / r.z}) - 1.0;
}

/* Aimed at a known point of the surface from outside on its visible side: that point is found.
 * Directions are scaled at random: t keeps its meaning. */
static void test_triaxial(void **state) {
  (void)state;
  test_random random = {.seed = 12};
  double worst = 0.0;
  print_message("seed 12\n");
  for (int i = 0; i < 100000; i++) {
    const double size = random_scale(&random, 1e-2, 1e9);
    const pl_vec3 r = {size * random_range(&random, 0.3, 1), size * random_range(&random, 0.3, 1),
                       size * random_range(&random, 0.3, 1)};
    const pl_vec3 s = random_direction(&random);
    const pl_vec3 target = {r.x * s.x, r.y * s.y, r.z * s.z};
    const pl_vec3 normal = pl_ellipsoid_normal(r, target);
    assert_true(fabs(pl_vec3_norm(normal) - 1.0) < 1e-15);
    pl_vec3 back = random_direction(&random);
    if (pl_vec3_dot(back, normal) < 0.0)
      back = pl_vec3_scale(back, -1.0);
    const double cosine = pl_vec3_dot(back, normal);
    if (cosine < 1e-3)
      continue;
    const double distance = size * random_scale(&random, 1e-3, 1e5);
    const double stretch = random_scale(&random, 1e-6, 1e6);
    const pl_vec3 origin = pl_vec3_madd(target, distance, back);
    double t;
    assert_true(pl_ellipsoid_intersect(r, origin, pl_vec3_scale(back, -stretch), 0.0, &t));
    /* Rounding of origin and t, magnified by the slope. */
    const double tolerance = 1e-14 * (distance + size) / cosine;
    worst = fmax(worst, fabs(t * stretch - distance) / tolerance);
    const pl_vec3 hit = pl_vec3_madd(origin, -t * stretch, back);
    worst = fmax(worst, fabs(level(r, hit)) * size / (10.0 * tolerance));
  }
  print_message("worst error: %.2g of the tolerance\n", worst);
  assert_true(worst < 1.0);
}

/* A ray misses just when the nearest point of its line to the centre, in scaled space, is out. */
static void test_hits_and_misses(void **state) {
  (void)state;
  test_random random = {.seed = 13};
  int hits = 0;
  print_message("seed 13\n");
  for (int i = 0; i < 100000; i++) {
    const pl_vec3 r = {random_scale(&random, 0.1, 10), random_scale(&random, 0.1, 10),
                       random_scale(&random, 0.1, 10)};
    const pl_vec3 o = pl_vec3_scale(random_direction(&random), random_scale(&random, 0.01, 1e4));
    const pl_vec3 d = pl_vec3_unit(
        pl_vec3_sub(pl_vec3_scale(random_direction(&random), random_range(&random, 0.0, 12.0)), o));
    const pl_vec3 f = {o.x / r.x, o.y / r.y, o.z / r.z}, e = {d.x / r.x, d.y / r.y, d.z / r.z};
    const double near = -pl_vec3_dot(f, e) / pl_vec3_dot(e, e);
    const double gap = pl_vec3_norm(pl_vec3_madd(f, near, e)) - 1.0;
    const bool inside = pl_vec3_norm(f) < 1.0;
    double t;
    const bool hit = pl_ellipsoid_intersect(r, o, d, 0.0, &t);
    if (fabs(gap) < 1e-9)
      continue;
    assert_int_equal(hit, gap < 0.0 && (inside || near > 0.0));
    if (hit)
      assert_true(fabs(level(r, pl_vec3_madd(o, t, d))) < 1e-9);
    hits += hit;
  }
  assert_in_range(hits, 10000, 90000);
}

static void test_lon_lat(void **state) {
  (void)state;
  double lon, lat;
  pl_ellipsoid_lon_lat((pl_vec3){1, 0, 0}, &lon, &lat);
  assert_true(lon == 0.0 && lat == 0.0);
  pl_ellipsoid_lon_lat((pl_vec3){0, 2, 0}, &lon, &lat);
  assert_true(fabs(lon - PL_PI / 2) < 1e-15 && lat == 0.0);
  pl_ellipsoid_lon_lat((pl_vec3){0, 0, -3}, &lon, &lat);
  assert_true(fabs(lat + PL_PI / 2) < 1e-15);
  pl_ellipsoid_lon_lat((pl_vec3){0, 0, 0}, &lon, &lat);
  assert_true(lon == 0.0 && lat == 0.0);
  test_random random = {.seed = 14};
  for (int i = 0; i < 1000; i++) {
    const pl_vec3 p = random_direction(&random);
    pl_ellipsoid_lon_lat(pl_vec3_scale(p, 5.0), &lon, &lat);
    const pl_vec3 q = {cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)};
    assert_true(pl_vec3_norm(pl_vec3_sub(p, q)) < 1e-15 * 4);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_reference),       cmocka_unit_test(test_inside_and_behind),
      cmocka_unit_test(test_t_min),           cmocka_unit_test(test_triaxial),
      cmocka_unit_test(test_hits_and_misses), cmocka_unit_test(test_lon_lat),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
