/* Metering. */
#include "harness.h"

#include "math/color.h"
#include "sensor/exposure.h"

static const pl_exposure median = {.automatic = true, .percentile = 50.0, .key = 0.5};

static double meter(const pl_exposure *exposure, const float *values, size_t count) {
  float copy[256];
  for (size_t i = 0; i < count; i++)
    copy[i] = values[i];
  return pl_exposure_meter(exposure, copy, count, 100.0);
}

static void test_percentile(void **state) {
  (void)state;
  float ramp[101];
  for (int i = 0; i <= 100; i++)
    ramp[100 - i] = (float)(50 + i); /* 50..150, unsorted */
  for (int p = 0; p <= 100; p += 5) {
    const pl_exposure exposure = {.automatic = true, .percentile = p, .key = 0.8};
    assert_true(fabs(meter(&exposure, ramp, 101) - (50.0 + p) / 0.8) < 1e-6 * 200);
  }
}

static void test_dark_pixels_do_not_count(void **state) {
  (void)state;
  float values[200] = {0};
  for (int i = 0; i < 10; i++)
    values[20 * i] = 40.0f; /* a spacecraft in a twentieth of the frame */
  assert_true(meter(&median, values, 200) == 80.0);
}

/* The disc of the sun or a glint, 1e4 times brighter than a lit surface, is a few pixels: the scene
 * still counts. */
static void test_a_glint_does_not_hide_the_scene(void **state) {
  (void)state;
  float values[200] = {0};
  for (int i = 0; i < 50; i++)
    values[i] = 40.0f;
  values[120] = 4e6f;
  values[121] = INFINITY;
  assert_true(meter(&median, values, 200) == 80.0);
}

/* Darker than a thousandth of a sunlit surface, but all that there is. */
static void test_a_dim_scene_counts(void **state) {
  (void)state;
  float values[10] = {0};
  for (int i = 0; i < 5; i++)
    values[i] = 1e-6f;
  assert_true(fabs(meter(&median, values, 10) - 2e-6) < 1e-12);
}

static void test_nothing_lit(void **state) {
  (void)state;
  const float values[4] = {0};
  assert_true(meter(&median, values, 4) == 100.0);
  assert_true(meter(&median, values, 0) == 100.0);
}

static void test_undefined_pixels(void **state) {
  (void)state;
  const float values[5] = {NAN, 40.0f, NAN, 40.0f, 40.0f};
  assert_true(meter(&median, values, 5) == 80.0);
}

static void test_luminance(void **state) {
  (void)state;
  assert_true(fabsf(pl_luminance((pl_vec3f){2.0f, 2.0f, 2.0f}) - 2.0f) < 1e-6f);
  assert_true(pl_luminance((pl_vec3f){0.0f, 1.0f, 0.0f}) == 0.7152f); /* Rec. 709 */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_percentile),
      cmocka_unit_test(test_dark_pixels_do_not_count),
      cmocka_unit_test(test_a_glint_does_not_hide_the_scene),
      cmocka_unit_test(test_a_dim_scene_counts),
      cmocka_unit_test(test_nothing_lit),
      cmocka_unit_test(test_undefined_pixels),
      cmocka_unit_test(test_luminance),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
