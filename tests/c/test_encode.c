/* Display encoding against the sRGB formula in long double. */
#include "harness.h"

#include "sensor/encode.h"

/* IEC 61966-2-1, exactly rounded: halves go up. */
static int exact(float x) {
  const long double v = x;
  if (!(v > 0.0L))
    return 0;
  if (v >= 1.0L)
    return 255;
  const long double e = v <= 0.0031308L ? 12.92L * v : 1.055L * powl(v, 1.0L / 2.4L) - 0.055L;
  return (int)floorl(255.0L * e + 0.5L);
}

static void test_dense_sweep(void **state) {
  (void)state;
  pl_encoder encoder;
  pl_encoder_init(&encoder);
  int last = 0;
  for (int i = -1000; i <= 1100000; i++) {
    const float x = (float)i * 1e-6f;
    const int code = pl_encode(&encoder, x);
    if (code != exact(x))
      fail_msg("x = %.9g: %d, exactly rounded %d", (double)x, code, exact(x));
    assert_true(code >= last);
    last = code;
  }
}

/* The floats on either side of every threshold. */
static void test_thresholds(void **state) {
  (void)state;
  pl_encoder encoder;
  pl_encoder_init(&encoder);
  for (int code = 1; code < 256; code++) {
    float x = encoder.threshold[code];
    for (int i = 0; i < 8; i++)
      x = nextafterf(x, 0.0f);
    for (int i = 0; i < 16; i++, x = nextafterf(x, 2.0f))
      if (pl_encode(&encoder, x) != exact(x))
        fail_msg("x = %.9g: %d, exactly rounded %d", (double)x, pl_encode(&encoder, x), exact(x));
  }
}

static void test_extremes(void **state) {
  (void)state;
  pl_encoder encoder;
  pl_encoder_init(&encoder);
  assert_int_equal(pl_encode(&encoder, NAN), 0);
  assert_int_equal(pl_encode(&encoder, -INFINITY), 0);
  assert_int_equal(pl_encode(&encoder, -0.0f), 0);
  assert_int_equal(pl_encode(&encoder, 1e-45f), 0);
  assert_int_equal(pl_encode(&encoder, nextafterf(1.0f, 0.0f)), 255);
  assert_int_equal(pl_encode(&encoder, INFINITY), 255);
}

static void test_rgb(void **state) {
  (void)state;
  pl_encoder encoder;
  pl_encoder_init(&encoder);
  const pl_vec3f radiance[2] = {{0.0f, 50.0f, 1e9f}, {25.0f, 100.0f, NAN}};
  uint8_t rgb[7] = {9, 9, 9, 9, 9, 9, 9};
  pl_encode_rgb(&encoder, radiance, 2, 100.0f, rgb);
  const uint8_t expected[7] = {0, 188, 255, 137, 255, 0, 9}; /* sRGB of 0.5 and 0.25 */
  assert_memory_equal(rgb, expected, sizeof expected);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_dense_sweep),
      cmocka_unit_test(test_thresholds),
      cmocka_unit_test(test_extremes),
      cmocka_unit_test(test_rgb),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
