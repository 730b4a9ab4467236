/* Filtered textures: levels, wrapping, footprints, and input that is out of bounds. */
#include "geom/texture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"

#include "base/memory.h"
#include "random.h"

#define assert_near(value, expected, tolerance)                                                    \
  assert_true(fabs((double)(value) - (double)(expected)) <= (double)(tolerance))

static const float NOTHING[2] = {0, 0};
static const float ALL_U[2] = {1, 0}, ALL_V[2] = {0, 1};

static pl_texture *make(int width, int height, int channels, const uint8_t *texels, bool srgb,
                        pl_wrap wrap) {
  pl_image image;
  assert_int_equal(pl_image_init(width, height, channels, &image), PL_OK);
  memcpy(image.texels, texels, (size_t)(width * height * channels));
  pl_texture *texture;
  assert_int_equal(pl_texture_create(&image, srgb, wrap, wrap, &texture), PL_OK);
  assert_null(image.texels);
  return texture;
}

static void fill_random(test_random *random, uint8_t *texels, size_t count) {
  for (size_t i = 0; i < count; i++)
    texels[i] = (uint8_t)random_range(random, 0, 255.999);
}

/* Linear value of an sRGB code: IEC 61966-2-1, written again here. */
static double linear_of(double code) {
  const double e = code / 255;
  return e <= 0.04045 ? e / 12.92 : pow((e + 0.055) / 1.055, 2.4);
}

static void codes_are_decoded(void **state) {
  (void)state;
  const uint8_t texels[4] = {188, 188, 188, 188};
  float out[4];
  pl_texture *texture = make(1, 1, 4, texels, true, PL_WRAP_REPEAT);
  pl_texture_sample(texture, 0.5f, 0.5f, NOTHING, NOTHING, PL_FILTER_FINEST, out);
  for (int c = 0; c < 3; c++)
    assert_near(out[c], 0.50288646, 1e-6); /* ((188/255 + 0.055) / 1.055)^2.4 */
  assert_near(out[3], 188 / 255.0, 1e-6);  /* alpha is never encoded */
  pl_texture_destroy(texture);
  texture = make(1, 1, 4, texels, false, PL_WRAP_REPEAT);
  pl_texture_sample(texture, 0.5f, 0.5f, NOTHING, NOTHING, PL_FILTER_FINEST, out);
  assert_near(out[0], 188 / 255.0, 1e-6);
  pl_texture_destroy(texture);
}

static void channels_spread_to_rgba(void **state) {
  (void)state;
  const uint8_t texels[4] = {51, 102, 153, 204};
  const float expected[5][4] = {{0},
                                {0.2f, 0.2f, 0.2f, 1},
                                {0.2f, 0.2f, 0.2f, 0.4f},
                                {0.2f, 0.4f, 0.6f, 1},
                                {0.2f, 0.4f, 0.6f, 0.8f}};
  for (int channels = 1; channels <= 4; channels++) {
    pl_texture *texture = make(1, 1, channels, texels, false, PL_WRAP_CLAMP);
    float out[4], mean[4];
    pl_texture_sample(texture, 7.3f, -2.0f, ALL_U, ALL_V, PL_FILTER_FINEST, out);
    pl_texture_mean(texture, mean);
    int width, height, stored;
    pl_texture_size(texture, &width, &height, &stored);
    assert_int_equal(stored, channels);
    for (int c = 0; c < 4; c++) {
      assert_near(out[c], expected[channels][c], 1e-6);
      assert_near(mean[c], expected[channels][c], 1e-6);
    }
    pl_texture_destroy(texture);
  }
}

/* A value at u on a row of four texels 0, 85, 170, 255 (linear: 0, 1/3, 2/3, 1). */
static float row_at(pl_wrap wrap, float u) {
  const uint8_t texels[4] = {0, 85, 170, 255};
  pl_texture *texture = make(4, 1, 1, texels, false, wrap);
  float out[4];
  pl_texture_sample(texture, u, 0.5f, NOTHING, NOTHING, PL_FILTER_FINEST, out);
  pl_texture_destroy(texture);
  return out[0];
}

static void lookups_are_bilinear_between_centres(void **state) {
  (void)state;
  for (int wrap = 0; wrap < 3; wrap++)
    for (int i = 0; i < 4; i++)
      assert_near(row_at((pl_wrap)wrap, ((float)i + 0.5f) / 4), i / 3.0, 1e-6);
  assert_near(row_at(PL_WRAP_CLAMP, 0.25f), 1 / 6.0, 1e-6);
  assert_near(row_at(PL_WRAP_CLAMP, 0.3125f), 0.25, 1e-6);
  /* In sRGB the mean is that of the light, not of the codes. */
  const uint8_t codes[2] = {0, 255};
  pl_texture *texture = make(2, 1, 1, codes, true, PL_WRAP_CLAMP);
  float out[4];
  pl_texture_sample(texture, 0.5f, 0.5f, NOTHING, NOTHING, PL_FILTER_FINEST, out);
  assert_near(out[0], 0.5, 1e-6);
  pl_texture_destroy(texture);
}

static void coordinates_wrap(void **state) {
  (void)state;
  assert_near(row_at(PL_WRAP_REPEAT, 0.0f), 0.5, 1e-6); /* between the last and the first */
  assert_near(row_at(PL_WRAP_REPEAT, 1.125f), 0.0, 1e-6);
  assert_near(row_at(PL_WRAP_REPEAT, -0.125f), 1.0, 1e-6);
  assert_near(row_at(PL_WRAP_REPEAT, -3.625f), 1 / 3.0, 1e-6);
  assert_near(row_at(PL_WRAP_REPEAT, -1e-12f), 0.5, 1e-6);
  assert_near(row_at(PL_WRAP_CLAMP, -0.3f), 0.0, 1e-6);
  assert_near(row_at(PL_WRAP_CLAMP, 25.0f), 1.0, 1e-6);
  assert_near(row_at(PL_WRAP_MIRROR, 1.0f), 1.0, 1e-6);
  assert_near(row_at(PL_WRAP_MIRROR, 1.125f), 1.0, 1e-6);
  assert_near(row_at(PL_WRAP_MIRROR, 1.375f), 2 / 3.0, 1e-6);
  assert_near(row_at(PL_WRAP_MIRROR, -0.375f), 1 / 3.0, 1e-6);
  assert_near(row_at(PL_WRAP_MIRROR, 2.125f), 0.0, 1e-6);
}

/* A footprint of the whole is the mean of all texels, whatever the sides: in linear light, within
 * half a code of the 8 bits that the level before the last is stored in. */
static void coarsest_level_is_the_mean(void **state) {
  (void)state;
  const int sides[][2] = {{1, 1}, {2, 2}, {3, 1}, {1, 7}, {5, 3}, {17, 31}, {64, 64}, {33, 2}};
  test_random random = {.seed = 7};
  uint8_t texels[64 * 64 * 3];
  for (size_t k = 0; k < sizeof sides / sizeof sides[0]; k++) {
    for (int srgb = 0; srgb < 2; srgb++) {
      const int w = sides[k][0], h = sides[k][1];
      fill_random(&random, texels, (size_t)(w * h * 3));
      pl_texture *texture = make(w, h, 3, texels, srgb, PL_WRAP_REPEAT);
      float coarse[4], mean[4];
      pl_texture_sample(texture, 0.3f, 0.9f, ALL_U, ALL_V, PL_FILTER_FINEST, coarse);
      pl_texture_mean(texture, mean);
      for (int c = 0; c < 3; c++) {
        double sum = 0;
        for (int i = 0; i < w * h; i++)
          sum += srgb ? linear_of(texels[3 * i + c]) : texels[3 * i + c] / 255.0;
        sum /= w * h;
        assert_near(mean[c], sum, 1e-6);
        /* the widest step of the curve is its last: linear_of(255) - linear_of(254) */
        const double step = srgb ? 1 - linear_of(254) : 1 / 255.0;
        assert_near(coarse[c], sum, 0.51 * step);
      }
      pl_texture_destroy(texture);
    }
  }
}

/* A half lies between two codes of sRGB, whose nearest is 0.6 % off: levels of it alternate. */
static void levels_keep_the_mean(void **state) {
  (void)state;
  enum { SIDE = 64 };
  uint8_t texels[SIDE * SIDE];
  for (int i = 0; i < SIDE * SIDE; i++)
    texels[i] = (i + i / SIDE) % 2 == 0 ? 255 : 0;
  pl_texture *texture = make(SIDE, SIDE, 1, texels, true, PL_WRAP_REPEAT);
  for (int level = 1; level <= 6; level++) {
    const int side = SIDE >> level;
    const float a[2] = {1.0f / (float)side, 0}, b[2] = {0, 1.0f / (float)side};
    double sum = 0;
    for (int i = 0; i < side * side; i++) {
      float out[4];
      pl_texture_sample(texture, ((float)(i % side) + 0.5f) / (float)side,
                        ((float)(i / side) + 0.5f) / (float)side, a, b, PL_FILTER_FINEST, out);
      sum += (double)out[0] / (side * side);
    }
    assert_near(sum, 0.5, side == 1 ? 1e-6 : 0.004 / (side * side) + 1e-5); /* half a code in all */
  }
  pl_texture_destroy(texture);
}

/* Five texels make two: each of the two covers two and a half. */
static void odd_sides_are_averaged_by_cover(void **state) {
  (void)state;
  const uint8_t texels[5] = {10, 200, 50, 90, 250};
  pl_texture *texture = make(5, 1, 1, texels, false, PL_WRAP_CLAMP);
  const float a[2] = {2 / 5.0f, 0}, b[2] = {0, 2}; /* two texels a side: exactly level 1 */
  float out[4];
  pl_texture_sample(texture, 0.25f, 0.5f, a, b, PL_FILTER_FINEST, out);
  assert_near(out[0] * 255, (10 + 200 + 25) / 2.5, 0.51);
  pl_texture_sample(texture, 0.75f, 0.5f, a, b, PL_FILTER_FINEST, out);
  assert_near(out[0] * 255, (25 + 90 + 250) / 2.5, 0.51);
  pl_texture_destroy(texture);
}

static void a_constant_texture_is_constant(void **state) {
  (void)state;
  test_random random = {.seed = 11};
  uint8_t texels[19 * 6];
  memset(texels, 77, sizeof texels);
  for (int wrap = 0; wrap < 3; wrap++) {
    pl_texture *texture = make(19, 6, 1, texels, true, (pl_wrap)wrap);
    for (int i = 0; i < 2000; i++) {
      const double size = pow(10, random_range(&random, -4, 1));
      float a[2], b[2], out[4];
      for (int k = 0; k < 2; k++) {
        a[k] = (float)(size * random_range(&random, -1, 1));
        b[k] = (float)(size * random_range(&random, -1, 1));
      }
      pl_texture_sample(texture, (float)random_range(&random, -3, 3),
                        (float)random_range(&random, -3, 3), a, b, PL_FILTER_FINEST, out);
      assert_near(out[0], linear_of(77), 2e-6);
    }
    pl_texture_destroy(texture);
  }
}

/* Columns of random grey: a footprint of one column that is long across rows must not blur them. */
static void long_footprints_stay_sharp_across(void **state) {
  (void)state;
  test_random random = {.seed = 3};
  uint8_t row[64], texels[64 * 64];
  fill_random(&random, row, sizeof row);
  for (int y = 0; y < 64; y++)
    memcpy(texels + 64 * y, row, 64);
  pl_texture *texture = make(64, 64, 1, texels, false, PL_WRAP_REPEAT);
  const float a[2] = {1 / 64.0f, 0}, b[2] = {0, 16 / 64.0f};
  for (int x = 0; x < 64; x++) {
    float out[4], swapped[4];
    pl_texture_sample(texture, ((float)x + 0.5f) / 64, 0.4f, a, b, PL_FILTER_FINEST, out);
    pl_texture_sample(texture, ((float)x + 0.5f) / 64, 0.4f, b, a, PL_FILTER_FINEST, swapped);
    assert_near(out[0], row[x] / 255.0, 1e-5);
    assert_near(swapped[0], out[0], 1e-6);
  }
  pl_texture_destroy(texture);
}

/* Mean of a smooth picture over the parallelogram, by brute force. */
static double wave(double u, double v) {
  return 0.5 + 0.25 * sin(6.283185307179586 * (3 * u + v)) +
         0.2 * cos(6.283185307179586 * (2 * v - u));
}

static double mean_over(double u, double v, const float a[2], const float b[2]) {
  double sum = 0;
  enum { N = 32 };
  for (int i = 0; i < N; i++) {
    for (int j = 0; j < N; j++) {
      const double s = (i + 0.5) / N - 0.5, t = (j + 0.5) / N - 0.5;
      sum += wave(u + s * (double)a[0] + t * (double)b[0], v + s * (double)a[1] + t * (double)b[1]);
    }
  }
  return sum / (N * N);
}

static void footprints_average_what_they_cover(void **state) {
  (void)state;
  enum { SIDE = 256 };
  uint8_t *texels = malloc(SIDE * SIDE);
  assert_non_null(texels);
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++)
      texels[SIDE * y + x] = (uint8_t)lround(255 * wave((x + 0.5) / SIDE, (y + 0.5) / SIDE));
  pl_texture *texture = make(SIDE, SIDE, 1, texels, false, PL_WRAP_REPEAT);
  free(texels);
  test_random random = {.seed = 5};
  double worst = 0;
  for (int i = 0; i < 500; i++) {
    float a[2], b[2], out[4];
    for (int k = 0; k < 2; k++) {
      a[k] = (float)random_range(&random, -0.12, 0.12);
      b[k] = (float)random_range(&random, -0.02, 0.02);
    }
    const double u = random_range(&random, 0, 1), v = random_range(&random, 0, 1);
    pl_texture_sample(texture, (float)u, (float)v, a, b, PL_FILTER_FINEST, out);
    worst = fmax(worst, fabs((double)out[0] - mean_over(u, v, a, b)));
  }
  /* Contrast is 0.9; an isotropic filter of the same level errs by 0.3 here. */
  assert_true(worst < 0.03);
  pl_texture_destroy(texture);
}

static void anything_gives_a_defined_value(void **state) {
  (void)state;
  const float odd[] = {0,     -0.0f, 1,     -1,       0.5f, 1e-30f,   -1e-30f,   1e9f,
                       -1e9f, 3e9f,  1e30f, -3.4e38f, NAN,  INFINITY, -INFINITY, 0.99999994f};
  enum { COUNT = sizeof odd / sizeof odd[0] };
  test_random random = {.seed = 13};
  uint8_t texels[7 * 5 * 3];
  fill_random(&random, texels, sizeof texels);
  for (int wrap = 0; wrap < 3; wrap++) {
    pl_texture *texture = make(7, 5, 3, texels, true, (pl_wrap)wrap);
    for (int i = 0; i < 20000; i++) {
      float in[6], out[4];
      for (int k = 0; k < 6; k++)
        in[k] = odd[(int)random_range(&random, 0, COUNT - 1e-9)];
      pl_texture_sample(texture, in[0], in[1], in + 2, in + 4, PL_FILTER_FINEST, out);
      for (int c = 0; c < 4; c++)
        assert_true(out[c] >= 0.0f && out[c] <= 1.00001f);
    }
    pl_texture_destroy(texture);
  }
}

static void levels_take_a_third_more(void **state) {
  (void)state;
  uint8_t texels[64 * 64] = {0};
  pl_texture *texture = make(64, 64, 1, texels, false, PL_WRAP_REPEAT);
  const size_t levels = 64 * 64 + 32 * 32 + 16 * 16 + 8 * 8 + 4 * 4 + 2 * 2 + 1;
  assert_true(pl_texture_bytes(texture) >= levels);
  assert_true(pl_texture_bytes(texture) < levels + 4096);
  pl_texture_destroy(texture);
  pl_texture_destroy(NULL);
}

static void *allocate_within(void *context, size_t size) {
  int *left = context;
  return (*left)-- > 0 ? malloc(size) : NULL;
}

static void failed_allocations_are_reported(void **state) {
  (void)state;
  for (int allowed = 0;; allowed++) {
    pl_image image;
    assert_int_equal(pl_image_init(9, 4, 3, &image), PL_OK);
    int left = allowed;
    pl_memory_hook(allocate_within, &left);
    pl_texture *texture;
    const pl_status status =
        pl_texture_create(&image, true, PL_WRAP_REPEAT, PL_WRAP_REPEAT, &texture);
    pl_memory_hook(NULL, NULL);
    assert_null(image.texels);
    if (status == PL_OK) {
      assert_true(allowed > 1);
      pl_texture_destroy(texture);
      return;
    }
    assert_int_equal(status, PL_E_MEMORY);
    assert_null(texture);
  }
}

/* Numbers of any size come out as they are, their levels are means, and nothing is cut. */
static void numbers_stay_as_they_are(void **state) {
  (void)state;
  enum { WIDTH = 37, HEIGHT = 21 };
  test_random random = {.seed = 9};
  float numbers[WIDTH * HEIGHT], out[4];
  double sum = 0.0;
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    numbers[i] = (float)random_range(&random, -9000.0, 11000.0);
    sum += (double)numbers[i];
  }
  pl_texture *texture;
  assert_int_equal(
      pl_texture_of_numbers(numbers, WIDTH, HEIGHT, PL_WRAP_REPEAT, PL_WRAP_CLAMP, &texture),
      PL_OK);
  for (int y = 0; y < HEIGHT; y++)
    for (int x = 0; x < WIDTH; x++) {
      const float u = ((float)x + 0.5f) / WIDTH, v = ((float)y + 0.5f) / HEIGHT;
      pl_texture_sample(texture, u, v, NOTHING, NOTHING, PL_FILTER_NONE, out);
      assert_true(out[0] == numbers[y * WIDTH + x] && out[2] == out[0] && out[3] == 1.0f);
      pl_texture_sample(texture, u, v, NOTHING, NOTHING, PL_FILTER_FINEST, out);
      assert_near(out[0], numbers[y * WIDTH + x], 0.2);
    }
  pl_texture_sample(texture, 0.5f, 0.5f, ALL_U, ALL_V, PL_FILTER_TRILINEAR, out);
  assert_near(out[0], sum / (WIDTH * HEIGHT), 0.01);
  int levels;
  const float *ranges = pl_texture_ranges(texture, &levels);
  assert_int_equal(levels, 6);
  assert_true(ranges[0] > 19000.0f && ranges[1] < ranges[0] && ranges[5] == 0.0f);
  assert_true(pl_texture_bytes(texture) >= 4 * WIDTH * HEIGHT);
  pl_texture_destroy(texture);
}

static void numbers_without_sides_or_memory_are_refused(void **state) {
  (void)state;
  const float numbers[6] = {1, 2, 3, 4, 5, 6};
  pl_texture *texture;
  assert_int_equal(pl_texture_of_numbers(numbers, 0, 2, PL_WRAP_REPEAT, PL_WRAP_CLAMP, &texture),
                   PL_E_ARGUMENT);
  assert_null(texture);
  pl_status status = PL_E_MEMORY;
  for (int allowed = 0; status != PL_OK; allowed++) {
    int left = allowed;
    pl_memory_hook(allocate_within, &left);
    status = pl_texture_of_numbers(numbers, 3, 2, PL_WRAP_REPEAT, PL_WRAP_CLAMP, &texture);
    pl_memory_hook(NULL, NULL);
    assert_true(status == PL_OK || (status == PL_E_MEMORY && texture == NULL && allowed < 3));
  }
  pl_texture_destroy(texture);
}

static void an_empty_image_is_refused(void **state) {
  (void)state;
  pl_image image = {0};
  pl_texture *texture;
  assert_int_equal(pl_texture_create(&image, true, PL_WRAP_REPEAT, PL_WRAP_REPEAT, &texture),
                   PL_E_ARGUMENT);
  assert_null(texture);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(codes_are_decoded),
      cmocka_unit_test(channels_spread_to_rgba),
      cmocka_unit_test(lookups_are_bilinear_between_centres),
      cmocka_unit_test(coordinates_wrap),
      cmocka_unit_test(coarsest_level_is_the_mean),
      cmocka_unit_test(levels_keep_the_mean),
      cmocka_unit_test(odd_sides_are_averaged_by_cover),
      cmocka_unit_test(a_constant_texture_is_constant),
      cmocka_unit_test(long_footprints_stay_sharp_across),
      cmocka_unit_test(footprints_average_what_they_cover),
      cmocka_unit_test(anything_gives_a_defined_value),
      cmocka_unit_test(levels_take_a_third_more),
      cmocka_unit_test(failed_allocations_are_reported),
      cmocka_unit_test(numbers_stay_as_they_are),
      cmocka_unit_test(numbers_without_sides_or_memory_are_refused),
      cmocka_unit_test(an_empty_image_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
