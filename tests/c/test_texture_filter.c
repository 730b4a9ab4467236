/* The filters of textures against each other: what they read lies within the ranges of the levels
 * that the footprint reaches, and finer filters are nearer to the mean over the footprint. */
#include "geom/texture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "random.h"

static const float NOTHING[2] = {0, 0};

static pl_texture *make(int width, int height, int channels, const uint8_t *texels, bool srgb,
                        pl_wrap wrap) {
  pl_image image;
  pl_texture *texture;
  assert_int_equal(pl_image_init(width, height, channels, &image), PL_OK);
  memcpy(image.texels, texels, (size_t)(width * height * channels));
  assert_int_equal(pl_texture_create(&image, srgb, wrap, wrap, &texture), PL_OK);
  return texture;
}

/* At the centres of texels every filter that resolves them gives them; in between the nearest one
 * is one of them, whatever the footprint. */
static void test_nearest_texel(void **state) {
  (void)state;
  const uint8_t texels[] = {10, 60, 110, 160, 210, 250};
  const float wide[2] = {0.9f, 0.0f};
  pl_texture *texture = make(3, 2, 1, texels, false, PL_WRAP_REPEAT);
  float out[4];
  for (int i = 0; i < 6; i++) {
    const float u = ((float)(i % 3) + 0.5f) / 3, v = ((float)(i / 3) + 0.5f) / 2;
    for (int filter = 0; filter < PL_FILTER_COUNT; filter++) {
      pl_texture_sample(texture, u, v, NOTHING, NOTHING, (pl_filter)filter, out);
      assert_true(fabsf(out[0] - (float)texels[i] / 255) < 2e-6f);
    }
    for (int filter = PL_FILTER_NONE; filter <= PL_FILTER_NEAREST; filter++) {
      const float *footprint = filter == PL_FILTER_NONE ? wide : NOTHING;
      pl_texture_sample(texture, u + 0.16f, v - 0.24f, footprint, footprint, (pl_filter)filter,
                        out);
      assert_true(fabsf(out[0] - (float)texels[i] / 255) < 2e-6f);
    }
  }
  pl_texture_destroy(texture);
}

/* Ranges: of the picture itself the largest step between its texels, in linear light; never
 * growing; nothing for the last level, which is one texel. */
static void test_ranges_fall(void **state) {
  (void)state;
  test_random random = {.seed = 21};
  uint8_t texels[33 * 18 * 3];
  for (size_t i = 0; i < sizeof texels; i++)
    texels[i] = (uint8_t)random_below(&random, 256);
  texels[0] = 255; /* red from 0 to 255 */
  texels[3] = 0;
  pl_texture *texture = make(33, 18, 3, texels, true, PL_WRAP_REPEAT);
  int levels;
  const float *ranges = pl_texture_ranges(texture, &levels);
  assert_int_equal(levels, 6); /* 33, 16, 8, 4, 2, 1 */
  assert_true(fabsf(ranges[0] - 1.0f) < 1e-6f);
  assert_true(ranges[levels - 1] == 0.0f);
  for (int k = 1; k < levels; k++)
    assert_true(ranges[k] <= ranges[k - 1]);
  assert_true(ranges[3] < 0.5f);
  pl_texture_destroy(texture);
  const uint8_t even[] = {7, 7, 7, 7};
  texture = make(2, 2, 1, even, true, PL_WRAP_CLAMP);
  assert_true(pl_texture_ranges(texture, &levels)[0] == 0.0f);
  pl_texture_destroy(texture);
}

/* A footprint with half the smaller singular value of its matrix in texels known: two axes at right
 * angles in texels, turned. */
static void footprint_of(test_random *random, int width, int height, double shorter, float a[2],
                         float b[2]) {
  const double longer = shorter * random_scale(random, 1.0, 60.0);
  const double turn = random_range(random, 0, 2 * PL_PI);
  a[0] = (float)(longer * cos(turn) / width);
  a[1] = (float)(longer * sin(turn) / height);
  b[0] = (float)(-shorter * sin(turn) / width);
  b[1] = (float)(shorter * cos(turn) / height);
}

static void check_ranges(test_random *random, const pl_texture *texture) {
  int width, height, channels, levels;
  const float *ranges = pl_texture_ranges(texture, &levels);
  pl_texture_size(texture, &width, &height, &channels);
  for (int i = 0; i < 4000; i++) {
    const int level = random_below(random, levels);
    float a[2], b[2], best[4], out[4];
    footprint_of(random, width, height, exp2(level + random_unit(random)) * 1.0001, a, b);
    const float u = (float)random_range(random, -2, 2), v = (float)random_range(random, -2, 2);
    pl_texture_sample(texture, u, v, a, b, PL_FILTER_FINEST, best);
    for (int filter = PL_FILTER_NONE; filter < PL_FILTER_COUNT; filter++) {
      pl_texture_sample(texture, u, v, a, b, (pl_filter)filter, out);
      const float range = ranges[filter == PL_FILTER_NONE ? 0 : level];
      for (int c = 0; c < channels; c++)
        assert_true(fabsf(out[c] - best[c]) <= range + 2e-6f);
    }
    pl_texture_box(texture, u, v, a, b, PL_FILTER_FINEST, out);
    for (int c = 0; c < channels; c++)
      assert_true(fabsf(out[c] - best[c]) <= ranges[level < 2 ? 0 : level - 2] + 2e-6f);
  }
}

static void test_filters_differ_within_ranges(void **state) {
  (void)state;
  static const int sizes[][2] = {{1, 1}, {2, 1}, {64, 32}, {61, 37}, {1, 40}};
  test_random random = {.seed = 22};
  for (int i = 0; i < 15; i++) {
    uint8_t texels[64 * 40 * 3];
    const double contrast = random_unit(&random);
    for (size_t k = 0; k < sizeof texels; k++)
      texels[k] = (uint8_t)(255 * (0.5 + contrast * (random_unit(&random) - 0.5)));
    pl_texture *texture =
        make(sizes[i % 5][0], sizes[i % 5][1], 3, texels, i % 2 == 0, (pl_wrap)(i / 5));
    check_ranges(&random, texture);
    pl_texture_destroy(texture);
  }
}

enum { SIDE = 256 };
static double wave(double u, double v) {
  return 0.5 + 0.25 * sin(6.283185307179586 * (23 * u + 4 * v)) +
         0.2 * cos(6.283185307179586 * (31 * v - 9 * u));
}

static double mean_over(double u, double v, const float a[2], const float b[2]) {
  enum { N = 24 };
  double sum = 0;
  for (int i = 0; i < N; i++)
    for (int j = 0; j < N; j++) {
      const double s = (i + 0.5) / N - 0.5, t = (j + 0.5) / N - 0.5;
      sum += wave(u + s * (double)a[0] + t * (double)b[0], v + s * (double)a[1] + t * (double)b[1]);
    }
  return sum / (N * N);
}

/* Root mean square difference of each filter from the mean over footprints of all shapes, found by
 * integrating the picture's own formula. */
static void test_finer_filters_are_nearer_to_the_mean(void **state) {
  (void)state;
  uint8_t *texels = malloc(SIDE * SIDE);
  assert_non_null(texels);
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++)
      texels[SIDE * y + x] = (uint8_t)lround(255 * wave((x + 0.5) / SIDE, (y + 0.5) / SIDE));
  pl_texture *texture = make(SIDE, SIDE, 1, texels, false, PL_WRAP_REPEAT);
  free(texels);
  test_random random = {.seed = 23};
  double square[PL_FILTER_COUNT] = {0}, box = 0.0;
  for (int i = 0; i < 1500; i++) {
    float a[2], b[2], out[4];
    footprint_of(&random, SIDE, SIDE, random_scale(&random, 0.5, 8.0), a, b);
    const double u = random_unit(&random), v = random_unit(&random);
    const double mean = mean_over(u, v, a, b);
    for (int filter = 0; filter < PL_FILTER_COUNT; filter++) {
      pl_texture_sample(texture, (float)u, (float)v, a, b, (pl_filter)filter, out);
      square[filter] += pow((double)out[0] - mean, 2.0) / 1500;
    }
    pl_texture_box(texture, (float)u, (float)v, a, b, PL_FILTER_FINEST, out);
    box += pow((double)out[0] - mean, 2.0) / 1500;
  }
  print_message("as a box: RMS error %.4f\n", sqrt(box));
  assert_true(box < 0.5 * square[PL_FILTER_FINEST]);
  for (int filter = 0; filter < PL_FILTER_COUNT; filter++)
    print_message("filter %d: RMS error %.4f\n", filter, sqrt(square[filter]));
  assert_true(square[PL_FILTER_BILINEAR] <= square[PL_FILTER_NEAREST]);
  assert_true(square[PL_FILTER_TRILINEAR] <= square[PL_FILTER_BILINEAR]);
  for (int filter = PL_FILTER_TAPS_2; filter < PL_FILTER_COUNT; filter++)
    assert_true(square[filter] <= 1.0001 * square[filter - 1]);
  assert_true(square[PL_FILTER_FINEST] < 0.25 * square[PL_FILTER_TRILINEAR]);
  assert_true(square[PL_FILTER_TRILINEAR] < 0.25 * square[PL_FILTER_NONE]);
  pl_texture_destroy(texture);
}

/* The cheaper filters stay what they are, and so do pictures of one colour. */
static void test_boxes_of_cheap_filters_and_of_nothing(void **state) {
  (void)state;
  const uint8_t texels[] = {10, 60, 110, 160, 210, 250};
  pl_texture *texture = make(3, 2, 1, texels, false, PL_WRAP_REPEAT);
  const float wide[2] = {0.5f, 0.1f}, high[2] = {0.0f, 0.7f}, none[2] = {NAN, INFINITY};
  float out[4], same[4];
  for (int filter = PL_FILTER_NONE; filter < PL_FILTER_TRILINEAR; filter++) {
    pl_texture_box(texture, 0.3f, 0.4f, wide, high, (pl_filter)filter, out);
    pl_texture_sample(texture, 0.3f, 0.4f, wide, high, (pl_filter)filter, same);
    assert_memory_equal(out, same, sizeof out);
  }
  pl_texture_box(texture, 0.3f, 0.4f, none, high, PL_FILTER_FINEST, out); /* all of it */
  assert_true(fabsf(out[0] - 800.0f / 6.0f / 255.0f) < 1e-6f);
  pl_texture_box(texture, NAN, 0.25f, NOTHING, NOTHING, PL_FILTER_FINEST, out);
  pl_texture_sample(texture, 0.0f, 0.25f, NOTHING, NOTHING, PL_FILTER_FINEST, same);
  assert_memory_equal(out, same, sizeof out);
  pl_texture_destroy(texture);
  const uint8_t even[] = {7, 7, 7, 7};
  texture = make(2, 2, 1, even, false, PL_WRAP_CLAMP);
  pl_texture_box(texture, 0.3f, 0.4f, wide, high, PL_FILTER_FINEST, out);
  assert_true(fabsf(out[0] - 7.0f / 255.0f) < 1e-6f);
  pl_texture_destroy(texture);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_nearest_texel),
      cmocka_unit_test(test_ranges_fall),
      cmocka_unit_test(test_filters_differ_within_ranges),
      cmocka_unit_test(test_finer_filters_are_nearer_to_the_mean),
      cmocka_unit_test(test_boxes_of_cheap_filters_and_of_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
