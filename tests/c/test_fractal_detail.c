/* Fractal detail: the law's structure function, variance everywhere, slopes, bits, refusals. */
#include "harness.h"

#include <math.h>

#include "detail_sum.h"
#include "random.h"

static const double RADIUS_M = 1737400.0;

static pl_terrain_detail law(double hurst) {
  return (pl_terrain_detail){.on = true,
                             .seed = 7,
                             .baseline_m = 10.0,
                             .deviation_m = 1.0,
                             .range_count = 1,
                             .ranges = {{0.0, hurst}},
                             .strength = 1.0,
                             .longest_m = 2000.0,
                             .finest_m = 0.5};
}

/* nu(L) of the sum of octaves, from their deviations and correlation. */
static double deviation_m(const pl_fractal_detail *detail, double lag_m) {
  double sum = 0.0;
  for (int k = detail->first; k <= detail->last; k++)
    sum += 2.0 * detail->sigma_m[k] * detail->sigma_m[k] *
           (1.0 - pl_detail_correlation(lag_m / pl_cube_cell_m(k, RADIUS_M)));
  return sqrt(sum);
}

static void test_law(void **state) {
  (void)state;
  const double exponents[] = {0.0, 0.3, 0.5, 0.76, 0.85, 0.95, 1.0};
  for (size_t n = 0; n < sizeof exponents / sizeof exponents[0]; n++) {
    pl_terrain_detail given = law(exponents[n]);
    pl_fractal_detail detail;
    pl_fractal_detail_init(&given, RADIUS_M, &detail);
    for (double lag_m = 1.0; lag_m <= 500.0; lag_m *= 1.2) {
      const double ratio = deviation_m(&detail, lag_m) / pow(lag_m / 10.0, exponents[n]);
      assert_true(ratio > 0.92 && ratio < 1.1);
    }
  }
  pl_terrain_detail moon = pl_terrain_detail_default(RADIUS_M);
  pl_fractal_detail detail;
  assert_true(fabs(pl_terrain_detail_deviation_m(&moon, 17.0) - 1.9) < 0.001);
  assert_true(fabs(pl_terrain_detail_deviation_m(&moon, 500.0) - 47.2) < 0.1);
  assert_true(fabs(pl_terrain_detail_deviation_m(&moon, 0.01) / 0.01448 - pow(0.1, 0.85)) < 0.002);
  pl_fractal_detail_init(&moon, RADIUS_M, &detail);
  for (double lag_m = 0.01; lag_m <= 1e5; lag_m *= 1.3) {
    const double ratio = deviation_m(&detail, lag_m) / pl_terrain_detail_deviation_m(&moon, lag_m);
    assert_true(ratio > 0.9 && ratio < 1.05);
  }
}

/* Any law and body has finite octaves. */
static void test_any_law(void **state) {
  (void)state;
  test_random random = {.seed = 8};
  for (int n = 0; n < PL_DRAWS(60, 10); n++) {
    pl_terrain_detail given = law(n % 3 < 2 ? n % 3 : random_unit(&random));
    const double radius_m = random_scale(&random, 1e3, 7.1e7);
    pl_fractal_detail detail;
    given.deviation_m = random_scale(&random, 1e-7, 1e5);
    given.longest_m = random_scale(&random, 1.0, radius_m);
    given.finest_m = random_scale(&random, 1e-2, given.longest_m);
    assert_int_equal(pl_terrain_detail_check(&given), PL_OK);
    pl_fractal_detail_init(&given, radius_m, &detail);
    assert_true(detail.first <= detail.last);
    for (int k = detail.first; k <= detail.last; k++)
      assert_true(isfinite(detail.sigma_m[k]) && detail.sigma_m[k] > 0.0);
  }
}

/* Octaves one by one, at the centres of faces, on edges and at corners of the cube, whose
 * directions cut the lattice differently: the same variance, and the correlation in any direction
 * that the law assumes. */
static void test_octaves(void **state) {
  (void)state;
  enum { COUNT = PL_DRAWS(20000, 500) };
  const pl_vec3 places[] = {
      {1.0, 0.0, 0.0}, {0.0, 0.0, -1.0}, {1.0, 1.0, 0.0}, {-1.0, 1.0, 1.0}, {1.0, 0.4, 0.2}};
  const int octave = 17, level = 22;
  pl_terrain_detail given = law(0.5);
  pl_fractal_detail detail;
  pl_fractal_detail_init(&given, RADIUS_M, &detail);
  for (int k = 0; k < PL_CUBE_LEVELS; k++)
    if (k != octave)
      detail.sigma_m[k] = 0.0;
  detail.first = detail.last = octave;
  detail.sigma_m[octave] = 1.0;
  const double step = pl_cube_cell_m(octave, RADIUS_M) / RADIUS_M;
  test_random random = {.seed = 3};
  for (size_t n = 0; n < sizeof places / sizeof places[0]; n++) {
    double square = 0.0, product = 0.0, mean = 0.0;
    for (int k = 0; k < COUNT; k++) {
      const pl_vec3 d =
          pl_vec3_unit(pl_vec3_madd(pl_vec3_unit(places[n]), 0.05, random_direction(&random)));
      const pl_vec3 along = pl_vec3_unit(pl_vec3_cross(d, random_direction(&random)));
      const double a = detail_height(&detail, d, 0, level);
      const double b = detail_height(&detail, pl_vec3_unit(pl_vec3_madd(d, step, along)), 0, level);
      mean += a / COUNT;
      square += a * a / COUNT;
      product += a * b / COUNT;
    }
    const double spread = 6.0 / sqrt(COUNT);
    assert_true(fabs(mean) < 0.5 * spread);
    assert_true(fabs(square - 1.0) < 1.5 * spread);
    assert_true(fabs(product - pl_detail_correlation(1.0)) < 1.5 * spread);
  }
}

static void test_gradient(void **state) {
  (void)state;
  pl_terrain_detail given = law(0.7);
  pl_fractal_detail detail;
  pl_fractal_detail_init(&given, RADIUS_M, &detail);
  test_random random = {.seed = 4};
  for (int k = 0; k < 100; k++) {
    const pl_vec3 d = random_direction(&random);
    const pl_vec3 along = pl_vec3_unit(pl_vec3_cross(d, random_direction(&random)));
    const int from = detail.first + random_below(&random, 4), to = detail.last;
    const double h = 1e-3 / RADIUS_M; /* of cells of 0.3 m; in double at this level */
    const pl_vec3 slope = detail_gradient(&detail, d, from, to);
    const double ahead = detail_height(&detail, pl_vec3_unit(pl_vec3_madd(d, h, along)), from, 40);
    const double behind =
        detail_height(&detail, pl_vec3_unit(pl_vec3_madd(d, -h, along)), from, 40);
    assert_true(fabs(pl_vec3_dot(slope, d)) < 1e-9 * pl_vec3_norm(slope) + 1e-9);
    assert_true(fabs((ahead - behind) / (2.0 * h) - pl_vec3_dot(slope, along)) <
                1e-4 * pl_vec3_norm(slope));
  }
}

/* Octaves summed in single precision for close nodes, and in double for distant ones, agree. */
static void test_near_and_far(void **state) {
  (void)state;
  pl_terrain_detail given = law(0.6);
  pl_fractal_detail detail;
  pl_fractal_detail_init(&given, RADIUS_M, &detail);
  test_random random = {.seed = 5};
  for (int k = 0; k < 200; k++) {
    const pl_vec3 d = random_direction(&random);
    const double a = detail_height(&detail, d, 0, detail.last);
    const double b = detail_height(&detail, d, 0, detail.last + PL_DETAIL_NEAR);
    assert_true(fabs(a - b) < 1e-5);
  }
}

/* A strip, with whatever the cache holds, has the bits of its points. */
static void test_strips(void **state) {
  (void)state;
  pl_terrain_detail given = law(0.8);
  pl_fractal_detail detail;
  pl_fractal_detail_init(&given, RADIUS_M, &detail);
  static pl_detail_cache cache;
  pl_detail_cache_init(&cache);
  test_random random = {.seed = 6};
  for (int n = 0; n < PL_DRAWS(40, 8); n++) {
    pl_detail_strip strip = {.count = (size_t)(1 + random_below(&random, PL_DETAIL_STRIP))};
    double sums_m[PL_DETAIL_STRIP] = {0.0};
    const pl_vec3 d = random_direction(&random);
    const pl_vec3 along = pl_vec3_cross(d, random_direction(&random));
    const double step = random_scale(&random, 1e-8, 1e-3);
    const int level = 12 + random_below(&random, 20), coarsest = random_below(&random, 14);
    for (size_t k = 0; k < strip.count; k++) {
      const pl_vec3 p = pl_vec3_unit(pl_vec3_madd(d, step * (double)k, along));
      strip.x[k] = p.x;
      strip.y[k] = p.y;
      strip.z[k] = p.z;
    }
    pl_detail_strip_close(&strip);
    for (int octave = level; octave >= coarsest; octave--)
      pl_fractal_detail_add(&detail, &strip, octave, level, &cache, sums_m);
    for (size_t k = 0; k < strip.count; k++) {
      const pl_vec3 p = {strip.x[k], strip.y[k], strip.z[k]};
      assert_true(detail_height(&detail, p, coarsest, level) == sums_m[k]);
    }
  }
}

static void test_seeds(void **state) {
  (void)state;
  const uint64_t seeds[] = {0, 1, (uint64_t)1 << 32, UINT64_MAX};
  double h[4];
  for (int k = 0; k < 4; k++) {
    pl_terrain_detail given = law(0.5);
    pl_fractal_detail detail;
    given.seed = seeds[k];
    pl_fractal_detail_init(&given, RADIUS_M, &detail);
    h[k] = detail_height(&detail, (pl_vec3){0.6, 0.0, 0.8}, 0, 30);
    assert_true(isfinite(h[k]) && h[k] != 0.0);
    for (int other = 0; other < k; other++)
      assert_true(h[k] != h[other]);
  }
}

static void test_off(void **state) {
  (void)state;
  const double zeros[2] = {0.0, 1.0};
  for (int k = 0; k < 3; k++) {
    pl_terrain_detail given = law(0.5);
    pl_fractal_detail detail;
    given.on = k != 0;
    given.deviation_m *= zeros[k != 1];
    given.strength *= zeros[k != 2];
    assert_int_equal(pl_terrain_detail_check(&given), PL_OK);
    pl_fractal_detail_init(&given, RADIUS_M, &detail);
    assert_true(detail.last < detail.first);
    assert_true(detail_height(&detail, (pl_vec3){0.0, 0.0, 1.0}, 0, 40) == 0.0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_law),          cmocka_unit_test(test_any_law),
      cmocka_unit_test(test_octaves),      cmocka_unit_test(test_gradient),
      cmocka_unit_test(test_near_and_far), cmocka_unit_test(test_strips),
      cmocka_unit_test(test_seeds),        cmocka_unit_test(test_off),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
