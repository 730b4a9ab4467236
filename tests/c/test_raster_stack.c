/* Rasters of a surface: constants, ramps, means over footprints, borders, bounds, errors. */
#include "harness.h"

#include <math.h>

#include "random.h"
#include "terrain/raster_stack.h"

static const double DEGREE = PL_PI / 180.0, RADIUS_M = 1737400.0;

enum { SIDE = 64, WIDE = 72, HIGH = 36 };
static const double POST_M = 100.0;

static pl_raster *patch(const float *samples) {
  const pl_raster_frame frame = {.samples = samples,
                                 .type = PL_RASTER_FLOAT32,
                                 .width = SIDE,
                                 .height = SIDE,
                                 .stride = SIDE,
                                 .scale = 1.0,
                                 .projection = {.kind = PL_PROJECTION_ORTHOGRAPHIC,
                                                .lon0_rad = 30.0 * DEGREE,
                                                .lat0_rad = 20.0 * DEGREE,
                                                .radius_m = RADIUS_M},
                                 .x0 = -0.5 * (SIDE - 1) * POST_M,
                                 .y0 = 0.5 * (SIDE - 1) * POST_M,
                                 .dx = POST_M,
                                 .dy = -POST_M};
  pl_raster *raster;
  assert_int_equal(pl_raster_create(&frame, &raster), PL_OK);
  return raster;
}

static pl_raster *whole(const float *samples) {
  const double step = 5.0 * DEGREE;
  const pl_raster_frame frame = {.samples = samples,
                                 .type = PL_RASTER_FLOAT32,
                                 .width = WIDE,
                                 .height = HIGH,
                                 .stride = WIDE,
                                 .scale = 1.0,
                                 .x0 = 0.5 * step,
                                 .y0 = 90.0 * DEGREE - 0.5 * step,
                                 .dx = step,
                                 .dy = -step};
  pl_raster *raster;
  assert_int_equal(pl_raster_create(&frame, &raster), PL_OK);
  return raster;
}

/* Stack of the rasters that are not NULL; borders of 8 posts. */
static pl_raster_stack stack_of(const pl_raster *low, const pl_raster *high) {
  const pl_raster_sheet sheets[2] = {{low != NULL ? low : high, 8.0}, {high, 8.0}};
  pl_raster_stack stack;
  assert_int_equal(pl_raster_stack_init(sheets, low != NULL && high != NULL ? 2 : 1, &stack),
                   PL_OK);
  return stack;
}

static pl_vec3 any_direction(test_random *random) {
  const double z = random_range(random, -1.0, 1.0), lon = random_range(random, 0.0, 2.0 * PL_PI);
  return (pl_vec3){sqrt(1.0 - z * z) * cos(lon), sqrt(1.0 - z * z) * sin(lon), z};
}

static void test_constant(void **state) {
  (void)state;
  static float samples[WIDE * HIGH];
  test_random random = {.seed = 1};
  for (int k = 0; k < WIDE * HIGH; k++)
    samples[k] = 0.375f;
  pl_raster *raster = whole(samples);
  const pl_raster_stack stack = stack_of(raster, NULL);
  assert_true(stack.low == 0.375 && stack.high == 0.375);
  assert_true(fabs(stack.mean.value - 0.375) < 1e-12 && stack.mean.below == 0.0);
  for (int k = 0; k < 300; k++) {
    const double width = exp(random_range(&random, -12.0, 1.0));
    const pl_raster_mix mix = pl_raster_stack_at(&stack, any_direction(&random), width);
    assert_true(mix.value == 0.375 && mix.below == 0.0);
  }
  pl_raster_destroy(raster);
}

/* A ramp stays a ramp at any footprint, away from the borders of the patch. */
static void test_ramp(void **state) {
  (void)state;
  static float samples[SIDE * SIDE];
  test_random random = {.seed = 2};
  for (int k = 0; k < SIDE * SIDE; k++)
    samples[k] = (float)(0.1 + 0.004 * (k % SIDE) + 0.003 * (k / SIDE));
  pl_raster *raster = patch(samples);
  const pl_raster_stack stack = stack_of(NULL, raster);
  for (int k = 0; k < 300; k++) {
    const double u = random_range(&random, 20.0, 43.0), v = random_range(&random, 20.0, 43.0);
    const double width = exp(random_range(&random, -4.0, log(7.9))) * POST_M / RADIUS_M;
    const pl_raster_mix mix = pl_raster_stack_at(&stack, pl_raster_direction(raster, u, v), width);
    assert_true(mix.below == 0.0);
    assert_true(fabs(mix.value - (0.1 + 0.004 * u + 0.003 * v)) < 1e-6);
  }
  pl_raster_destroy(raster);
}

/* The mean of values over a tiling of the patch is the mean of its posts at any footprint, so that
 * brightness does not depend on the distance; over checks of one post, which vanish from afar. */
static void test_footprints_keep_the_mean(void **state) {
  (void)state;
  static float samples[SIDE * SIDE];
  for (int k = 0; k < SIDE * SIDE; k++)
    samples[k] = (k % SIDE + k / SIDE) % 2 == 0 ? 0.2f : 0.6f;
  pl_raster *raster = patch(samples);
  const pl_raster_stack stack = stack_of(NULL, raster);
  for (double posts = 0.125; posts <= 4.0; posts *= sqrt(2.0)) {
    double sum = 0.0, most = 0.0;
    int count = 0;
    for (double v = 16.125; v < 48.0; v += 0.25)
      for (double u = 16.125; u < 48.0; u += 0.25, count++) {
        const pl_raster_mix mix = pl_raster_stack_at(&stack, pl_raster_direction(raster, u, v),
                                                     posts * POST_M / RADIUS_M);
        sum += mix.value;
        most = fmax(most, fabs(mix.value - 0.4));
      }
    assert_true(fabs(sum / count - 0.4) < 1e-3);
    assert_true(most <= (posts >= 2.0 ? 1e-6 : 0.2 + 1e-6));
  }
  pl_raster_destroy(raster);
}

/* Neither footprints nor borders make a step, and a patch seen from afar is its fraction of a
 * pixel.
 */
static void test_no_step(void **state) {
  (void)state;
  static float samples[SIDE * SIDE], base[WIDE * HIGH];
  test_random random = {.seed = 3};
  for (int k = 0; k < SIDE * SIDE; k++)
    samples[k] = (float)random_range(&random, 0.7, 0.9);
  for (int k = 0; k < WIDE * HIGH; k++)
    base[k] = (float)random_range(&random, 0.1, 0.3);
  pl_raster *raster = patch(samples), *below = whole(base);
  const pl_raster_stack stack = stack_of(below, raster);
  const pl_vec3 middle = pl_raster_direction(raster, 31.5, 31.5);
  double last = NAN;
  for (double posts = 0.01; posts < 4e3; posts *= 1.002) {
    const pl_raster_mix mix = pl_raster_stack_at(&stack, middle, posts * POST_M / RADIUS_M);
    assert_true(mix.below == 0.0);
    assert_true(isnan(last) || fabs(mix.value - last) < 3e-3);
    last = mix.value;
  }
  const double fraction = (SIDE - 8.0) / 4e3;
  const pl_raster_stack alone = stack_of(NULL, raster);
  const pl_raster_mix far = pl_raster_stack_at(&alone, middle, 4e3 * POST_M / RADIUS_M);
  assert_true(fabs(1.0 - far.below - fraction * fraction) < 1e-6);
  for (double u = -40.0; u < 104.0; u += 0.05) {
    const pl_vec3 d = pl_raster_direction(raster, u, 31.5);
    const double value = pl_raster_stack_at(&stack, d, 0.1 * POST_M / RADIUS_M).value;
    assert_true(u == -40.0 || fabs(value - last) < 0.02);
    last = value;
  }
  pl_raster_destroy(raster);
  pl_raster_destroy(below);
}

/* The mean of a body, beside sums weighted by area. */
static void test_mean_of_body(void **state) {
  (void)state;
  static float samples[WIDE * HIGH];
  double sum = 0.0, area = 0.0;
  for (int row = 0; row < HIGH; row++) {
    const double weight = cos((87.5 - 5.0 * row) * DEGREE);
    for (int column = 0; column < WIDE; column++) {
      samples[row * WIDE + column] = row < 6 ? 0.9f : column < 20 ? 0.1f : 0.3f;
      sum += weight * (double)samples[row * WIDE + column];
      area += weight;
    }
  }
  pl_raster *raster = whole(samples);
  const pl_raster_stack stack = stack_of(raster, NULL);
  assert_true(fabs(stack.mean.value - sum / area) < 2e-3);
  pl_raster_destroy(raster);
}

static void test_errors(void **state) {
  (void)state;
  static float samples[WIDE * HIGH];
  pl_raster *raster = whole(samples);
  pl_raster_stack stack;
  const pl_raster_sheet sheet = {raster, NAN};
  assert_int_equal(pl_raster_stack_init(&sheet, 1, &stack), PL_E_RANGE);
  assert_int_equal(pl_raster_stack_init(&sheet, PL_RASTER_STACK + 1, &stack), PL_E_RANGE);
  assert_int_equal(pl_raster_stack_init(NULL, 0, &stack), PL_OK);
  assert_true(stack.count == 0 && stack.mean.value == 0.0 && stack.mean.below == 1.0);
  pl_raster_destroy(raster);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_constant),
      cmocka_unit_test(test_ramp),
      cmocka_unit_test(test_footprints_keep_the_mean),
      cmocka_unit_test(test_no_step),
      cmocka_unit_test(test_mean_of_body),
      cmocka_unit_test(test_errors),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
