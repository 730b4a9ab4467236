/* Tracks of wheels: cross section, imprints, bends, crossings, footprints, bits. */
#include "harness.h"

#include <string.h>

#include "random.h"
#include "terrain/wheel_tracks.h"

#define RADIUS_M 1737400.0
enum { POINTS = 257 };

static const pl_wheel_shape smooth_wheels = {
    .gauge_m = 1.6, .width_m = 0.3, .depth_m = 0.02, .albedo = 0.8};

/* A place (m east, m north) about the point of longitude and latitude 0. */
static pl_vec3 at(double east_m, double north_m) {
  return pl_vec3_scale(pl_vec3_unit((pl_vec3){RADIUS_M, east_m, north_m}), RADIUS_M);
}

static pl_wheel_tracks *made(const pl_wheel_track *tracks, size_t count) {
  pl_wheel_tracks *out = NULL;
  if (pl_wheel_tracks_create(tracks, count, &out) != PL_OK)
    fail_msg("%s", pl_error_text());
  return out;
}

/* 80 m straight to the east. */
static pl_wheel_tracks *straight(const pl_wheel_shape *shape) {
  pl_vec3 points[POINTS];
  for (int k = 0; k < POINTS; k++)
    points[k] = at(-40.0 + 80.0 * k / (POINTS - 1), 0.0);
  return made(&(pl_wheel_track){points, POINTS, *shape}, 1);
}

static double height(const pl_wheel_tracks *tracks, double east_m, double north_m, double cell_m) {
  const pl_vec3 d = pl_vec3_unit(at(east_m, north_m));
  double h = 0.0;
  pl_wheel_tracks_add_heights(tracks, &d, 1, cell_m, &h);
  return h;
}

static double albedo(const pl_wheel_tracks *tracks, double east_m, double north_m, double width_m) {
  return pl_wheel_tracks_albedo(tracks, pl_vec3_unit(at(east_m, north_m)), width_m);
}

static void test_cross_section(void **state) {
  (void)state;
  pl_wheel_tracks *tracks = straight(&smooth_wheels);
  double low, high, before = 0.0;
  pl_wheel_tracks_bounds(tracks, &low, &high);
  for (int side = -1; side <= 1; side += 2) {
    assert_true(fabs(height(tracks, 1.3, side * 0.8, 0.001) + 0.02) < 1e-9);
    assert_true(fabs(height(tracks, 1.3, side * (0.8 + 0.1), 0.001) + 0.02) < 1e-9);
    assert_true(fabs(height(tracks, 1.3, side * (0.8 + 1.25 * 0.15), 0.001) - 0.006) < 1e-9);
    assert_true(height(tracks, 1.3, side * 0.4, 0.001) == 0.0);
    assert_true(height(tracks, 1.3, side * 1.3, 0.001) == 0.0);
  }
  for (double y = -1.2; y < 1.2; y += 1e-4) { /* no steps */
    const double h = height(tracks, 1.3, y, 0.001);
    assert_true(fabs(h - before) < 1e-4 * 1.2);
    assert_true(h >= low && h <= high);
    before = h;
  }
  assert_true(height(tracks, 39.999, 0.8, 0.001) > -1e-5); /* it begins and ends smoothly */
  assert_true(height(tracks, 40.1, 0.8, 0.001) == 0.0);
  assert_true(height(tracks, 0.0, 0.8, 0.31) == 0.0); /* narrower than cells */
  pl_wheel_tracks_destroy(tracks);
}

static void test_imprints(void **state) {
  (void)state;
  pl_wheel_shape shape = smooth_wheels;
  shape.spacing_m = 0.08;
  shape.imprint_m = 0.006;
  shape.chevron_rad = 0.5;
  pl_wheel_tracks *tracks = straight(&shape);
  double low = 0.0, high = -1.0, sum = 0.0;
  for (int k = 0; k < 80; k++) {
    const double h = height(tracks, 1.0 + 0.001 * k, 0.8, 0.001);
    low = fmin(low, h);
    high = fmax(high, h);
    sum += h / 80;
    assert_true(fabs(h - height(tracks, 1.08 + 0.001 * k, 0.8, 0.001)) < 1e-7);
    /* A chevron: a place beside the middle is as deep as one further back on it. */
    assert_true(fabs(height(tracks, 1.0 + 0.001 * k, 0.87, 0.001) -
                     height(tracks, 1.0 + 0.001 * k + 0.07 * tan(0.5), 0.8, 0.001)) < 1e-7);
    assert_true(fabs(height(tracks, 1.0 + 0.001 * k, 0.73, 0.001) -
                     height(tracks, 1.0 + 0.001 * k, 0.87, 0.001)) < 1e-9);
  }
  assert_true(fabs(low + 0.026) < 1e-5 && fabs(high + 0.02) < 1e-5);
  assert_true(fabs(sum + 0.023) < 1e-6);
  assert_true(fabs(height(tracks, 1.01, 0.8, 0.04) + 0.023) < 1e-9); /* wide cells: the mean */
  pl_wheel_tracks_destroy(tracks);
}

/* What darkens the ground across the path does not depend on the footprint. */
static void test_albedo(void **state) {
  (void)state;
  pl_wheel_tracks *tracks = straight(&smooth_wheels);
  for (double width = 0.01; width < 3.0; width *= 2.3) {
    double sum = 0.0;
    for (double y = -4.0; y < 4.0; y += 0.002)
      sum += 0.002 * (1.0 - albedo(tracks, 0.7, y, width));
    assert_true(fabs(sum / (0.2 * 2.0 * 0.3) - 1.0) < 0.01);
  }
  assert_true(fabs(albedo(tracks, 0.7, 0.8, 0.01) - 0.8) < 1e-9);
  assert_true(albedo(tracks, 0.7, 0.0, 0.01) == 1.0);
  assert_true(pl_wheel_tracks_touch(tracks, pl_vec3_unit(at(0.0, 0.75)), 0.0));
  assert_true(!pl_wheel_tracks_touch(tracks, pl_vec3_unit(at(0.0, 0.0)), 0.6));
  assert_true(pl_wheel_tracks_touch(tracks, pl_vec3_unit(at(0.0, 0.0)), 0.7));
  pl_wheel_tracks_destroy(tracks);
}

/* Both ruts of a narrow turn are closed and have their depth all around. */
static void test_bend(void **state) {
  (void)state;
  enum { CORNERS = 25 };
  pl_vec3 points[CORNERS];
  for (int k = 0; k < CORNERS; k++)
    points[k] =
        at(2.0 * cos(1.5 * PL_PI * k / (CORNERS - 1)), 2.0 * sin(1.5 * PL_PI * k / (CORNERS - 1)));
  pl_wheel_tracks *tracks = made(&(pl_wheel_track){points, CORNERS, smooth_wheels}, 1);
  for (int side = -1; side <= 1; side += 2)
    for (double turn = 0.2; turn < 4.5; turn += 0.003) {
      const double r = 2.0 + side * 0.8;
      assert_true(fabs(height(tracks, r * cos(turn), r * sin(turn), 0.001) + 0.02) < 1e-9);
    }
  pl_wheel_tracks_destroy(tracks);
}

/* Where two cross, the ruts are no deeper; heaps do not fill ruts. Any block has the same bits. */
static void test_crossing_and_bits(void **state) {
  (void)state;
  enum { N = 300 };
  pl_vec3 east[POINTS], north[POINTS], directions[N];
  double block[N] = {0.0};
  test_random random = {.seed = 3};
  for (int k = 0; k < POINTS; k++) {
    const double along = -40.0 + 80.0 * k / (POINTS - 1);
    east[k] = at(along, 0.0);
    north[k] = at(0.3, along);
  }
  pl_wheel_shape shape = smooth_wheels;
  shape.spacing_m = 0.1;
  const pl_wheel_track both[2] = {{east, POINTS, shape}, {north, POINTS, shape}};
  pl_wheel_tracks *tracks = made(both, 2);
  for (double x = -2.0; x < 2.0; x += 0.01)
    assert_true(fabs(height(tracks, x, 0.8, 0.001) + 0.02) < 1e-9);
  for (int k = 0; k < N; k++)
    directions[k] =
        pl_vec3_unit(at(random_range(&random, -45.0, 45.0), random_range(&random, -2.0, 2.0)));
  pl_wheel_tracks_add_heights(tracks, directions, N, 0.01, block);
  for (int k = 0; k < N; k++) {
    double h = 0.0;
    pl_wheel_tracks_add_heights(tracks, &directions[k], 1, 0.01, &h);
    assert_true(h == block[k]);
  }
  pl_wheel_tracks_destroy(tracks);
}

static void test_refuses(void **state) {
  (void)state;
  const pl_vec3 points[3] = {at(0.0, 0.0), at(1.0, 0.0), at(1.0, 0.0)};
  pl_wheel_shape shape = smooth_wheels;
  pl_wheel_tracks *out;
  assert_int_equal(pl_wheel_tracks_create(&(pl_wheel_track){points, 1, shape}, 1, &out),
                   PL_E_RANGE);
  assert_int_equal(pl_wheel_tracks_create(&(pl_wheel_track){points, 3, shape}, 1, &out),
                   PL_E_RANGE);
  shape.gauge_m = 0.2;
  assert_int_equal(pl_wheel_tracks_create(&(pl_wheel_track){points, 2, shape}, 1, &out),
                   PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "gauge"));
  shape = smooth_wheels;
  shape.albedo = NAN;
  assert_int_equal(pl_wheel_tracks_create(&(pl_wheel_track){points, 2, shape}, 1, &out),
                   PL_E_RANGE);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_cross_section),
      cmocka_unit_test(test_imprints),
      cmocka_unit_test(test_albedo),
      cmocka_unit_test(test_bend),
      cmocka_unit_test(test_crossing_and_bits),
      cmocka_unit_test(test_refuses),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
