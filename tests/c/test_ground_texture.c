/* Textures of the ground: a texture of one value, means of footprints, slopes, what is refused. */
#include "harness.h"

#include <string.h>

#include "random.h"
#include "terrain/cube.h"
#include "terrain/ground_texture.h"

#define RADIUS_M 1737400.0
enum { SIDE = 64 };

static pl_raster *image(const float *samples, size_t width, size_t height) {
  pl_raster *out = NULL;
  const pl_raster_frame frame = {
      .samples = samples,
      .type = PL_RASTER_FLOAT32,
      .width = width,
      .height = height,
      .scale = 1.0,
      .projection = {.kind = PL_PROJECTION_ORTHOGRAPHIC, .radius_m = 1e9},
      .dx = 1.0,
      .dy = -1.0};
  assert_int_equal(pl_raster_create(&frame, &out), PL_OK);
  return out;
}

/* A wave along columns and one along rows, of whole numbers of periods. */
static void waves(float samples[SIDE * SIDE]) {
  for (int j = 0; j < SIDE; j++)
    for (int i = 0; i < SIDE; i++)
      samples[j * SIDE + i] =
          (float)(0.01 * (sin(2.0 * PL_PI * 8.0 * i / SIDE) + sin(2.0 * PL_PI * 8.0 * j / SIDE)));
}

/* One value everywhere: no deviations of heights, and itself as a factor. */
static void test_one_value(void **state) {
  (void)state;
  float samples[SIDE * SIDE];
  test_random random = {.seed = 1};
  for (int k = 0; k < SIDE * SIDE; k++)
    samples[k] = 1.25f;
  pl_raster *raster = image(samples, SIDE, SIDE);
  pl_ground_texture texture = {.heights = raster, .albedo = raster, .size_m = 3.0};
  assert_int_equal(pl_ground_texture_init(&texture, RADIUS_M), PL_OK);
  for (int k = 0; k < PL_DRAWS(3000, 50); k++) {
    const pl_vec3 d = random_direction(&random);
    const double width = exp(random_range(&random, -6.0, 3.0));
    assert_true(fabs(pl_ground_texture_at(&texture, PL_GROUND_HEIGHTS, RADIUS_M, d, width)) < 1e-6);
    assert_true(fabs(pl_ground_texture_at(&texture, PL_GROUND_ALBEDO, RADIUS_M, d, width) - 1.25) <
                1e-6);
    assert_true(pl_ground_texture_at(&texture, PL_GROUND_ROUGHNESS, RADIUS_M, d, width) == 1.0);
  }
  assert_true(pl_ground_texture_variance(&texture, 0.0) < 1e-12);
  assert_true(fabs(pl_ground_texture_brightest(&texture) - 1.25) < 1e-6);
  pl_raster_destroy(raster);
}

/* The variance of slopes is that of the image's waves and of weights that change across them, and
 * that of the slopes that are laid. */
static void test_slopes(void **state) {
  (void)state;
  enum { N = 100000 };
  float samples[SIDE * SIDE];
  test_random random = {.seed = 2};
  waves(samples);
  pl_raster *raster = image(samples, SIDE, SIDE);
  pl_ground_texture texture = {.heights = raster, .size_m = 6.4, .seed = 7};
  assert_int_equal(pl_ground_texture_init(&texture, RADIUS_M), PL_OK);
  /* Waves of 8 texels, less what cubic interpolation between them loses. */
  const double wave = 2.0 * PL_PI / 0.8, seen = 0.9966; /* root mean square over places */
  const double slope = 0.01 * wave * seen, edge = 1.6;
  const double expected = 0.5 * slope * slope + 5.357 * 0.01 * 0.01 / (edge * edge);
  const double stated = pl_ground_texture_variance(&texture, 0.0);
  assert_true(fabs(stated / expected - 1.0) < 0.02);
  double sum = 0.0;
  const int draws = PL_DRAWS(N, 200);
  for (int k = 0; k < draws; k++) {
    const pl_vec3 s =
        pl_ground_texture_slope(&texture, RADIUS_M, random_direction(&random), 0.0, INFINITY);
    sum += 0.5 * pl_vec3_dot(s, s) / draws;
  }
  assert_true(fabs(sum / stated - 1.0) < PL_DRAWS(0.01, 0.3));
  /* Footprints of four periods have none, and the bound holds. */
  assert_true(pl_ground_texture_variance(&texture, 3.2) < 0.02 * stated);
  assert_true(pl_ground_texture_bound_m(&texture) >= 0.02);
  pl_raster_destroy(raster);
}

/* A coordinate of a direction beside an edge goes on smoothly beyond it. */
static void test_faces_beside(void **state) {
  (void)state;
  test_random random = {.seed = 3};
  for (int k = 0; k < PL_DRAWS(2000, 50); k++) {
    const pl_vec3 d = random_direction(&random);
    int face;
    double s, t, u, v;
    pl_cube_locate(d, &face, &s, &t);
    assert_true(pl_cube_beside(face, d, &u, &v));
    assert_true(fabs(u - s) < 1e-14 && fabs(v - t) < 1e-14);
    for (int other = 0; other < PL_CUBE_FACES; other++)
      if (other != face && pl_cube_beside(other, d, &u, &v)) {
        const pl_vec3 back = pl_cube_direction(other, u, v);
        assert_true(pl_vec3_norm(pl_vec3_sub(back, d)) < 1e-14);
        assert_true(fmax(fabs(u), fabs(v)) > 1.0 - 1e-12);
      }
  }
}

static void test_refuses(void **state) {
  (void)state;
  float samples[SIDE * SIDE];
  waves(samples);
  pl_raster *square = image(samples, SIDE, SIDE), *wide = image(samples, SIDE, SIDE / 2);
  pl_ground_texture none = {.size_m = 1.0};
  assert_int_equal(pl_ground_texture_init(&none, RADIUS_M), PL_E_ARGUMENT);
  pl_ground_texture large = {.heights = square, .size_m = 1e6};
  assert_int_equal(pl_ground_texture_init(&large, RADIUS_M), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "1e+06"));
  pl_ground_texture zero = {.heights = square};
  assert_int_equal(pl_ground_texture_init(&zero, RADIUS_M), PL_E_RANGE);
  pl_ground_texture unlike = {.heights = square, .albedo = wide, .size_m = 1.0};
  assert_int_equal(pl_ground_texture_init(&unlike, RADIUS_M), PL_E_RANGE);
  pl_raster_destroy(square);
  pl_raster_destroy(wide);
}

/* Slopes are those of heights, and differences of two footprints their difference. */
static void test_slopes_of_heights(void **state) {
  (void)state;
  float samples[SIDE * SIDE];
  test_random random = {.seed = 5};
  waves(samples);
  pl_raster *raster = image(samples, SIDE, SIDE);
  pl_ground_texture texture = {.heights = raster, .size_m = 6.4, .seed = 9};
  assert_int_equal(pl_ground_texture_init(&texture, RADIUS_M), PL_OK);
  const double step_m = 1e-3;
  double off = 0.0, whole = 0.0;
  for (int k = 0; k < 200; k++) {
    const pl_vec3 d = random_direction(&random);
    const pl_vec3 s = pl_ground_texture_slope(&texture, RADIUS_M, d, 0.0, INFINITY);
    const pl_vec3 along = pl_vec3_unit(pl_vec3_cross(d, (pl_vec3){0.3, -0.5, 0.8}));
    double h[2];
    for (int end = 0; end < 2; end++)
      h[end] = pl_ground_texture_at(
          &texture, PL_GROUND_HEIGHTS, RADIUS_M,
          pl_vec3_unit(pl_vec3_madd(d, (end == 0 ? -step_m : step_m) / RADIUS_M, along)), 0.0);
    const double rise = (h[1] - h[0]) / (2.0 * step_m);
    off += (rise - pl_vec3_dot(s, along)) * (rise - pl_vec3_dot(s, along));
    whole += rise * rise;
    const pl_vec3 wide = pl_ground_texture_slope(&texture, RADIUS_M, d, 0.4, INFINITY);
    const pl_vec3 less = pl_ground_texture_slope(&texture, RADIUS_M, d, 0.0, 0.4);
    assert_true(pl_vec3_norm(pl_vec3_sub(pl_vec3_sub(s, wide), less)) < 1e-12);
  }
  assert_true(sqrt(off / whole) < 1e-3);
  pl_raster_destroy(raster);
}

/* Heights of many points are those of each, to the bit, whatever the order. */
static void test_runs(void **state) {
  (void)state;
  enum { COUNT = 400 };
  float samples[SIDE * SIDE];
  test_random random = {.seed = 6};
  waves(samples);
  pl_raster *raster = image(samples, SIDE, SIDE);
  pl_ground_texture texture = {.heights = raster, .size_m = 6.4, .seed = 9};
  assert_int_equal(pl_ground_texture_init(&texture, RADIUS_M), PL_OK);
  pl_vec3 directions[COUNT];
  double heights[COUNT] = {0.0};
  const pl_vec3 middle = random_direction(&random);
  for (int k = 0; k < COUNT; k++)
    directions[k] = pl_vec3_unit(
        pl_vec3_madd(middle, k < COUNT / 2 ? 0.02 * k / RADIUS_M : 1.0, random_direction(&random)));
  pl_ground_texture_add_heights(&texture, RADIUS_M, directions, COUNT, 0.05, heights);
  for (int k = 0; k < COUNT; k++)
    assert_true(heights[k] ==
                pl_ground_texture_at(&texture, PL_GROUND_HEIGHTS, RADIUS_M, directions[k], 0.05));
  pl_raster_destroy(raster);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_one_value), cmocka_unit_test(test_slopes_of_heights),
      cmocka_unit_test(test_slopes),    cmocka_unit_test(test_faces_beside),
      cmocka_unit_test(test_refuses),   cmocka_unit_test(test_runs),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
