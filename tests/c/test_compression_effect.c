/* JPEG of random pictures: off by no more than the row says, grey stays grey, any size. */
#include "harness.h"

#include "plan/effects.h"
#include "io/jpeg_write.h"
#include "random.h"
#include "sensors.h"

enum { SIDE = 40 };

/* Noise, stripes of extremes, or a ramp, grey or coloured. */
static void paint(test_random *random, int width, int height, bool grey, uint8_t *rgb) {
  const int pattern = random_below(random, 3);
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++)
      for (int band = 0; band < 3; band++) {
        const int noise = random_below(random, 256);
        const int value = pattern == 0   ? noise
                          : pattern == 1 ? 255 * ((x + (1 + band) * y) & 1)
                                         : (5 * x + 3 * band * y) % 256;
        uint8_t *pixel = rgb + 3 * (y * width + x);
        pixel[band] = grey && band > 0 ? pixel[0] : (uint8_t)value;
      }
}

static void pictures_stay_within_the_bound(void **state) {
  (void)state;
  test_random random = {.seed = 41};
  double tightest = 0.0;
  pl_arena arena;
  pl_arena_init(&arena);
  for (int round = 0; round < 400; round++) {
    const bool grey = round % 2 == 0;
    pl_sensor sensor = sensor_plain();
    sensor.mosaic = grey ? PL_MOSAIC_MONO : PL_MOSAIC_RGGB;
    sensor.compression.quality =
        round < 20 ? 100 - round / 10 * 99 : 1 + random_below(&random, 100);
    sensor.compression.chroma = (pl_chroma)random_below(&random, PL_CHROMAS);
    assert_int_equal(pl_sensor_check(&sensor), PL_OK);
    const pl_view view = {.sensor = &sensor, .width = SIDE, .height = SIDE};
    const double bound = pl_effect_compression.bound_dn(&view, 0);
    const int width = 1 + random_below(&random, SIDE), height = 1 + random_below(&random, SIDE);
    uint8_t before[3 * SIDE * SIDE], after[3 * SIDE * SIDE];
    paint(&random, width, height, grey, before);
    memcpy(after, before, sizeof after);
    pl_arena_reset(&arena);
    assert_int_equal(pl_jpeg_cycle(&sensor.compression, width, height, &arena, after), PL_OK);
    for (int i = 0; i < 3 * width * height; i++) {
      if (!(abs(after[i] - before[i]) <= bound))
        fail_msg("quality %d, chroma %d: off by %d, bound %g", sensor.compression.quality,
                 (int)sensor.compression.chroma, abs(after[i] - before[i]), bound);
      assert_true(!grey || after[i] == after[i / 3 * 3]);
      if (bound < 255.0)
        tightest = fmax(tightest, abs(after[i] - before[i]) / bound);
    }
  }
  print_message("up to %.2g of bounds that say something\n", tightest);
  assert_true(tightest > 0.1); /* all 64 coefficients are never off at once */
  pl_arena_clear(&arena);
}

static void black_and_white_stay(void **state) {
  (void)state;
  pl_arena arena;
  pl_arena_init(&arena);
  for (int white = 0; white <= 255; white += 255)
    for (int quality = 1; quality <= 100; quality++) {
      const pl_compression compression = {quality, PL_CHROMA_420};
      uint8_t rgb[3 * 17 * 9];
      memset(rgb, white, sizeof rgb);
      pl_arena_reset(&arena);
      assert_int_equal(pl_jpeg_cycle(&compression, 17, 9, &arena, rgb), PL_OK);
      /* the mean has steps of an eighth of the table's first, 16 at a quality of 50 */
      const int step = quality < 50 ? 800 / quality / 10 : 2;
      for (size_t i = 0; i < sizeof rgb; i++)
        assert_true(abs(rgb[i] - white) <= (step < 32 ? step : 32) / 2 + 1);
    }
  pl_arena_clear(&arena);
}

static void wrong_numbers_are_refused(void **state) {
  (void)state;
  pl_sensor sensor = sensor_plain();
  sensor.compression.quality = 101;
  assert_int_equal(pl_sensor_check(&sensor), PL_E_RANGE);
  sensor.compression = (pl_compression){50, PL_CHROMAS};
  assert_int_equal(pl_sensor_check(&sensor), PL_E_RANGE);
  pl_arena arena;
  pl_arena_init(&arena);
  uint8_t rgb[3] = {0};
  const pl_compression compression = {50, PL_CHROMA_444};
  assert_int_equal(pl_jpeg_cycle(&compression, 70000, 1, &arena, rgb), PL_E_FORMAT);
  pl_arena_clear(&arena);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pictures_stay_within_the_bound),
      cmocka_unit_test(black_and_white_stay),
      cmocka_unit_test(wrong_numbers_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
