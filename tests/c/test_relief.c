/* Slopes of height and normal maps on bodies, at the poles and the date line too. */
#include "harness.h"

#include <math.h>

#include "geom/ellipsoid.h"
#include "random.h"
#include "shade/ground.h"

enum { WIDTH = 512, HEIGHT = 256 };
static const double RADIUS = 1000e3;

/* A map of `channels` channels, values 0..1 by direction from the body's centre. */
typedef void (*map_fn)(pl_vec3 direction, double out[3]);
static pl_texture *map_of(map_fn fn, int channels, int width, int height) {
  pl_image image;
  pl_texture *texture;
  assert_int_equal(pl_image_init(width, height, channels, &image), PL_OK);
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++) {
      const double lon = 2.0 * PL_PI * ((x + 0.5) / width - 0.5);
      const double lat = PL_PI * (0.5 - (y + 0.5) / height);
      double value[3];
      fn((pl_vec3){cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)}, value);
      for (int c = 0; c < channels; c++)
        image.texels[(y * width + x) * channels + c] =
            (uint8_t)lrint(255.0 * fmin(1.0, fmax(0.0, value[c])));
    }
  assert_int_equal(pl_texture_create(&image, false, PL_WRAP_REPEAT, PL_WRAP_CLAMP, &texture),
                   PL_OK);
  return texture;
}

/* A ramp along a direction that is not the axis: smooth everywhere, also over the poles. */
static const pl_vec3 UPHILL = {0.48, 0.6, 0.64};
static void ramp(pl_vec3 d, double out[3]) { out[0] = 0.5 + 0.5 * pl_vec3_dot(d, UPHILL); }

/* Normals that lean by a third of the part of a fixed vector that lies in the ground. */
static const pl_vec3 LEAN = {0.2, -0.15, 0.25};
static void leaning(pl_vec3 d, double out[3]) {
  const pl_vec3 east = pl_vec3_unit((pl_vec3){-d.y, d.x, 0.0}), north = pl_vec3_cross(d, east);
  const pl_vec3 flat = pl_vec3_madd(LEAN, -pl_vec3_dot(LEAN, d), d);
  const pl_vec3 n = pl_vec3_unit(pl_vec3_add(d, flat));
  out[0] = 0.5 + 0.5 * pl_vec3_dot(n, east);
  out[1] = 0.5 + 0.5 * pl_vec3_dot(n, north);
  out[2] = 0.5 + 0.5 * pl_vec3_dot(n, d);
}

/* A square footprint on the ground. */
static pl_body_place place_at(pl_vec3 d, double width) {
  const pl_vec3 seed = fabs(d.x) < 0.7 ? (pl_vec3){1, 0, 0} : (pl_vec3){0, 1, 0};
  const pl_vec3 t = pl_vec3_unit(pl_vec3_cross(d, seed));
  return (pl_body_place){pl_vec3_scale(d, RADIUS), pl_vec3_scale(t, width),
                         pl_vec3_scale(pl_vec3_cross(d, t), width), 0.0, 0.0};
}

/* Everywhere, a third at the poles and a third at the date line. */
static pl_vec3 direction(test_random *random, int i) {
  const double far = random_scale(random, 1e-9, 0.02), turn = random_range(random, -PL_PI, PL_PI);
  if (i % 3 == 0)
    return pl_vec3_unit((pl_vec3){far * cos(turn), far * sin(turn), i % 2 ? 1.0 : -1.0});
  if (i % 3 == 1) {
    const double lat = random_range(random, -1.5, 1.5);
    return pl_vec3_unit((pl_vec3){-cos(lat), (i % 2 ? far : -far) * cos(lat), sin(lat)});
  }
  return random_direction(random);
}

/* The rounding of heights to 8 bits, 784 m here, is at most half a step at both ends of what is
 * compared, 60 km or more apart: 0.013. The slope of h (d . u)/2 over a sphere is h/(2 r) of the
 * part of u in the ground. */
static void test_heights_rise_as_they_do(void **state) {
  (void)state;
  test_random random = {.seed = 71};
  pl_texture *map = map_of(ramp, 1, WIDTH, HEIGHT);
  const pl_ground ground = {.heights = map};
  const pl_ground_state given = {.height_m = 200e3f};
  double worst = 0.0;
  for (int i = 0; i < 3000; i++) {
    const pl_vec3 d = direction(&random, i);
    const pl_body_place place = place_at(d, random_range(&random, 0.06, 0.1) * RADIUS);
    const pl_vec3 slope = pl_ground_slope(&ground, &given, &place, d, PL_FILTER_FINEST);
    const pl_vec3 flat = pl_vec3_madd(UPHILL, -pl_vec3_dot(UPHILL, d), d);
    worst = fmax(worst, pl_vec3_norm(pl_vec3_sub(slope, pl_vec3_scale(flat, 0.1))));
    assert_true(fabs(pl_vec3_dot(slope, d)) < 1e-6);
  }
  print_message("seed 71: slopes of up to 0.1 are off by at most %.4f\n", worst);
  assert_true(worst < 0.013);
  pl_texture_destroy(map);
}

static double worst_of_normals(const pl_texture *map, double narrow, double wide) {
  test_random random = {.seed = 72};
  const pl_ground ground = {.normals = map, .north = 1.0f};
  const pl_ground_state given = {.steepness = 2.0f};
  double worst = 0.0;
  for (int i = 0; i < 3000; i++) {
    const pl_vec3 d = direction(&random, i);
    const pl_body_place place = place_at(d, random_scale(&random, narrow, wide) * RADIUS);
    const pl_vec3 slope = pl_ground_slope(&ground, &given, &place, d, PL_FILTER_FINEST);
    const pl_vec3 flat = pl_vec3_madd(LEAN, -pl_vec3_dot(LEAN, d), d);
    worst = fmax(worst, pl_vec3_norm(pl_vec3_madd(slope, 2.0, flat)));
  }
  return worst;
}

/* A normal that leans to one side tells of ground that falls to that side. Near the poles the map's
 * own axes turn within a footprint, also in a part of one that is the pole's. */
static void test_normals_lean_downhill(void **state) {
  (void)state;
  pl_texture *map = map_of(leaning, 3, WIDTH, HEIGHT);
  const double fine = worst_of_normals(map, 1e-5, 0.004), coarse = worst_of_normals(map, 0.01, 0.1);
  print_message("seed 72: slopes of up to 0.7 are off by at most %.4f, in wide footprints %.4f\n",
                fine, coarse);
  assert_true(fine < 0.08 && coarse < 0.03);
  pl_texture_destroy(map);
}

static void test_green_may_point_south(void **state) {
  (void)state;
  pl_texture *map = map_of(leaning, 3, 64, 32);
  const pl_vec3 d = {1.0, 0.0, 0.0};
  const pl_body_place place = place_at(d, 1.0);
  const pl_ground_state given = {.steepness = 1.0f};
  const pl_vec3 north = pl_ground_slope(&(pl_ground){.normals = map, .north = 1.0f}, &given, &place,
                                        d, PL_FILTER_FINEST);
  const pl_vec3 south = pl_ground_slope(&(pl_ground){.normals = map, .north = -1.0f}, &given,
                                        &place, d, PL_FILTER_FINEST);
  assert_true(fabs(north.y - south.y) < 1e-6 && fabs(north.z + south.z) < 1e-6);
  assert_true(fabs(north.z) > 0.2);
  pl_texture_destroy(map);
}

static void lower_half(pl_vec3 d, double out[3]) {
  out[0] = out[1] = 0.5;
  out[2] = d.z > 0.0 ? 0.0 : 1.0;
}

/* Maps of one texel, of a row, of a column; normals that point down or lie flat: finite, and flat
 * where there is nothing to tell. */
static void test_odd_maps(void **state) {
  (void)state;
  test_random random = {.seed = 73};
  const int sizes[][2] = {{1, 1}, {2, 1}, {1, 2}, {3, 5}};
  for (int k = 0; k < 4; k++) {
    pl_texture *heights = map_of(ramp, 1, sizes[k][0], sizes[k][1]);
    pl_texture *normals = map_of(lower_half, 3, sizes[k][0], sizes[k][1]);
    const pl_ground ground = {.heights = heights, .normals = normals, .north = 1.0f};
    const pl_ground_state given = {.height_m = 1e4f, .steepness = 1.0f};
    for (int i = 0; i < 300; i++) {
      const pl_vec3 d = direction(&random, i);
      const pl_body_place place = place_at(d, random_scale(&random, 1e-9, 1.0) * RADIUS);
      for (int filter = 0; filter < PL_FILTER_COUNT; filter++) {
        const pl_vec3 slope = pl_ground_slope(&ground, &given, &place, d, (pl_filter)filter);
        assert_true(isfinite(slope.x) && isfinite(slope.y) && isfinite(slope.z));
      }
    }
    pl_texture_destroy(heights);
    pl_texture_destroy(normals);
  }
  pl_texture *one = map_of(ramp, 1, 1, 1);
  const pl_body_place place = place_at((pl_vec3){0.0, 0.6, 0.8}, 10.0);
  const pl_vec3 slope =
      pl_ground_slope(&(pl_ground){.heights = one}, &(pl_ground_state){.height_m = 1e4f}, &place,
                      (pl_vec3){0.0, 0.6, 0.8}, PL_FILTER_FINEST);
  assert_true(pl_vec3_norm(slope) == 0.0);
  pl_texture_destroy(one);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_heights_rise_as_they_do),
      cmocka_unit_test(test_normals_lean_downhill),
      cmocka_unit_test(test_green_may_point_south),
      cmocka_unit_test(test_odd_maps),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
