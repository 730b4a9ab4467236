/* What clouds cover, and the light that a layer of them sends back. */
#include "harness.h"

#include "clouds.h"
#include "math/fractal.h"
#include "textures.h"

static const double RANGE = 1e-5;

/* Meador and Weaver (1980), eq. 15 and the delta-Eddington row of their table 1, without
 * absorption, by hand for g = 0.85, depth 10: scaled depth 2.775, asymmetry 0.4594595,
 * gamma1 = 0.4054054, gamma3 = 0.5 - 0.3445946 mu. */
static void test_reflected(void **state) {
  (void)state;
  assert_near((double)pl_cloud_reflected(10.0f, 1.0f),
              (0.4054054 * 2.775 + (0.1554054 - 0.4054054) * (1.0 - exp(-2.775))) /
                  (1.0 + 0.4054054 * 2.775),
              RANGE);
  assert_near((double)pl_cloud_reflected(10.0f, 0.5f),
              (1.125 + (0.3277027 - 0.2027027) * (1.0 - exp(-5.55))) / 2.125, RANGE);
  assert_near((double)pl_cloud_reflected(0.0f, 0.3f), 0.0f, 0.0f);
  assert_near((double)pl_cloud_straight(2.0f, 0.5f), exp(-4.0), 1e-6f);
  for (float depth = 1e-4f; depth < 2e6f; depth *= 3.0f)
    for (float mu = 1e-3f; mu <= 1.0f; mu += 0.0333f) {
      const float r = pl_cloud_reflected(depth, mu);
      assert_true(r >= 0.0f && r <= 1.0f);
      assert_true(r <= pl_cloud_reflected(2.0f * depth, mu) + 1e-6f);
    }
}

static pl_clouds noisy(float coverage) {
  pl_clouds out = overcast(1e4, 10.0f);
  out.coverage = coverage;
  out.octaves = 7.0f;
  out.size_m = 1000.0;
  return out;
}

static double cover_at(const pl_cloud_cover *cover, pl_vec3 point, double width_m) {
  return (double)pl_cloud_cover_at(cover, point, (pl_vec3){width_m, 0.0, 0.0},
                                   (pl_vec3){0.0, width_m, 0.0});
}

/* The mean cover is the coverage, however wide the footprints and however few octaves count. The
 * noise is not quite normal: off by up to 0.02. */
static void test_mean_is_the_coverage(void **state) {
  (void)state;
  static const double widths[] = {0.0, 30.0, 300.0, 1500.0, 1e5};
  for (int k = 1; k < 10; k += 2) {
    pl_clouds clouds = noisy(0.1f * (float)k);
    clouds.warp = k == 5 ? 0.5f : 0.0f;
    for (int detail = 0; detail <= 8; detail += 4)
      for (size_t w = 0; w < sizeof widths / sizeof *widths; w++) {
        const pl_cloud_cover cover = pl_cloud_cover_make(&clouds, NULL, detail);
        test_random random = {.seed = 5};
        moments m = {0};
        for (int i = 0; i < 4000; i++)
          moments_add(&m, cover_at(&cover, random_point(&random, 3e5), widths[w]));
        assert_near(moments_mean(&m), 0.1 * k, 0.025);
        if (widths[w] == 0.0 && detail == 8) /* there are clouds, and gaps */
          assert_true(moments_variance(&m) > 0.03);
      }
  }
}

/* A wide footprint is the mean of the narrow ones in it. */
static void test_footprint_is_the_mean(void **state) {
  (void)state;
  const pl_clouds clouds = noisy(0.4f);
  const pl_cloud_cover cover = pl_cloud_cover_make(&clouds, NULL, 16);
  test_random random = {.seed = 8};
  double square = 0.0;
  enum { PLACES = 60, PARTS = 200 };
  for (int k = 0; k < PLACES; k++) {
    const pl_vec3 place = random_point(&random, 1e5);
    moments m = {0};
    for (int i = 0; i < PARTS; i++)
      moments_add(&m, cover_at(&cover, disc_point(place, PL_QUAT_IDENTITY, 150.0, i, PARTS), 1.0));
    const double off = cover_at(&cover, place, 150.0 * sqrt(PL_PI / 4.0)) - moments_mean(&m);
    square += off * off / PLACES;
  }
  assert_true(sqrt(square) < 0.06);
}

/* Octaves that are left out change the cover by no more than is said. */
static void test_detail_error(void **state) {
  (void)state;
  test_random random = {.seed = 21};
  double worst = 0.0;
  for (int round = 0; round < 60; round++) {
    pl_clouds clouds = random_clouds(&random, 1e4);
    const double width = random_scale(&random, 1.0, 3e3);
    const int detail = random_below(&random, 9);
    clouds.warp = 0.0f;
    const pl_cloud_cover all = pl_cloud_cover_make(&clouds, NULL, 16);
    const pl_cloud_cover some = pl_cloud_cover_make(&clouds, NULL, detail);
    const double allowed = (double)clouds.opacity * pl_clouds_detail_error(&clouds, detail, width);
    for (int i = 0; i < 100; i++) {
      const pl_vec3 place = random_point(&random, 1e5);
      const double w = width * (1.0 + random_unit(&random)) * 0.88622692545;
      const double off = fabs(cover_at(&all, place, w) - cover_at(&some, place, w));
      assert_true(off <= allowed + 1e-5);
      worst = fmax(worst, off);
    }
  }
  assert_true(worst > 0.05);
}

/* The shell turns: what is at longitude 0 goes east. */
static void test_turn(void **state) {
  (void)state;
  pl_clouds clouds = noisy(0.5f);
  const pl_cloud_cover still = pl_cloud_cover_make(&clouds, NULL, 16);
  clouds.turn_rad = 0.7;
  const pl_cloud_cover turned = pl_cloud_cover_make(&clouds, NULL, 16);
  for (int i = 0; i < 50; i++) {
    const double lon = 0.13 * i, z = 1e3 * i - 2.5e4;
    const pl_vec3 there = {1e5 * cos(lon), 1e5 * sin(lon), z};
    const pl_vec3 east = {1e5 * cos(lon + 0.7), 1e5 * sin(lon + 0.7), z};
    assert_near(cover_at(&still, there, 1.0), cover_at(&turned, east, 1.0), 1e-3);
  }
}

static void test_valid(void **state) {
  (void)state;
  pl_clouds clouds = noisy(0.5f);
  assert_true(pl_clouds_valid(&clouds));
  clouds.softness = 0.0f;
  assert_false(pl_clouds_valid(&clouds));
  clouds.altitude_m = 0.0; /* then there are none */
  assert_true(pl_clouds_valid(&clouds));
  clouds = noisy(0.5f);
  clouds.turn_rad = NAN;
  assert_false(pl_clouds_valid(&clouds));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_reflected),
      cmocka_unit_test(test_mean_is_the_coverage),
      cmocka_unit_test(test_footprint_is_the_mean),
      cmocka_unit_test(test_detail_error),
      cmocka_unit_test(test_turn),
      cmocka_unit_test(test_valid),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
