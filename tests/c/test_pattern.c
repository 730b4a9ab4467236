/* Regular patterns: the closed forms against sums of points. Places, widths and edges are multiples
 * of 1/16, so that the midpoints of a grid of 1/32 give the mean over a box exactly. */
#include "harness.h"
#include "math/pattern.h"
#include "textures.h"

#define STEP (1.0 / 32.0)

static double sixteenth(test_random *random, double low, double high) {
  return rint(16.0 * random_range(random, low, high)) / 16.0;
}
static double eighth_width(test_random *random, double most) {
  return fmax(1.0, rint(8.0 * random_range(random, 0.0, most))) / 8.0;
}

static const pl_bricks BRICKS = {0.125f, 0.25f, 0.5f};
static const pl_panel PANEL = {0.25f, 0.25f, 3.0f, 1.0f, 0.125f, 0.5f};

/* Brick, bare cell, metal and gap at a point, or over a box. */
static void plane_patterns(double u, double v, double width_u, double width_v, double out[4]) {
  const pl_panel_cover cover = pl_panel_covers(&PANEL, u, v, (float)width_u, (float)width_v);
  out[0] = (double)pl_brick_cover(&BRICKS, u, v, (float)width_u, (float)width_v);
  out[1] = (double)cover.cell;
  out[2] = (double)cover.metal;
  out[3] = (double)cover.gap;
}

static void test_plane_boxes(void **state) {
  (void)state;
  test_random random = {41, 0};
  for (int i = 0; i < 300; i++) {
    const double far = i % 3 == 0 ? 1e7 : 0.0; /* an even number of rows */
    const double u = far + sixteenth(&random, -4.0, 4.0), v = -far + sixteenth(&random, -4.0, 4.0);
    const double width_u = eighth_width(&random, 4.0), width_v = eighth_width(&random, 4.0);
    const int count_u = (int)(width_u / STEP), count_v = (int)(width_v / STEP);
    double sum[4] = {0}, mean[4], at[4];
    for (int k = 0; k < count_v; k++)
      for (int j = 0; j < count_u; j++) {
        plane_patterns(u - 0.5 * width_u + (j + 0.5) * STEP, v - 0.5 * width_v + (k + 0.5) * STEP,
                       0.0, 0.0, at);
        for (int n = 0; n < 4; n++)
          sum[n] += at[n] / (count_u * count_v);
      }
    plane_patterns(u, v, width_u, width_v, mean);
    for (int n = 0; n < 4; n++)
      assert_true(fabs(sum[n] - mean[n]) < 1e-6);
    assert_true(fabs(mean[1] + mean[2] + mean[3] - 1.0) < 1e-6);
  }
}

/* Means of everything: bricks 0.875 x 0.75; cells 0.75^2, bare (0.75 - 3/8) x (0.75 - 1/2). */
static void test_plane_means(void **state) {
  (void)state;
  static const double expected[4] = {0.65625, 0.09375, 0.46875, 0.4375};
  static const double widths[] = {2.0, 300.0, 5000.0, INFINITY};
  for (size_t k = 0; k < sizeof widths / sizeof widths[0]; k++) {
    double mean[4];
    plane_patterns(0.3, 0.8, widths[k], widths[k], mean);
    for (int n = 0; n < 4; n++)
      assert_true(fabs(mean[n] - expected[n]) < 1e-6);
  }
}

/* No lines, more lines than fit, gaps as wide as cells, numbers that are none: shares stay shares.
 */
static void test_degenerate_panels(void **state) {
  (void)state;
  static const float odd[] = {-1.0f, 0.0f, 0.5f, 1.0f, 2.0f, 1e30f, NAN, INFINITY};
  test_random random = {42, 0};
  for (int i = 0; i < 20000; i++) {
    float p[10];
    for (int k = 0; k < 10; k++)
      p[k] = odd[random_below(&random, 8)];
    const pl_panel panel = {p[0], p[1], p[2], p[3], p[4], p[5]};
    const pl_bricks bricks = {p[0], p[1], p[2]};
    const double u = i % 50 ? random_range(&random, -3.0, 3.0) : (double)p[8];
    const pl_panel_cover c = pl_panel_covers(&panel, u, (double)p[9] * u, p[6], p[7]);
    assert_true(c.cell >= 0.0f && c.metal >= 0.0f && c.gap >= 0.0f);
    assert_true(fabsf(c.cell + c.metal + c.gap - 1.0f) < 1e-5f);
    const float cover = pl_brick_cover(&bricks, u, -u, p[6], p[7]);
    assert_true(cover >= 0.0f && cover <= 1.0f + 1e-5f);
  }
  const pl_panel plain = {.gap_u = 0.1f, .gap_v = 0.2f};
  const pl_panel_cover c = pl_panel_covers(&plain, 0.0, 0.0, INFINITY, INFINITY);
  assert_true(fabsf(c.cell - 0.72f) < 1e-6f && c.metal == 0.0f);
}

static void test_ids(void **state) {
  (void)state;
  test_random random = {43, 0};
  for (int i = 0; i < 5000; i++) {
    const double u = random_below(&random, 1000) - 500, v = 2 * (random_below(&random, 1000) - 500);
    const uint32_t id = pl_brick_id(&BRICKS, u + 0.01, v + 0.01, 1);
    assert_int_equal(id, pl_brick_id(&BRICKS, u + 0.99, v + 0.99, 1));
    assert_int_not_equal(id, pl_brick_id(&BRICKS, u + 1.01, v + 0.5, 1));
    assert_int_equal(pl_brick_id(&BRICKS, u + 0.51, v + 1.5, 1), /* a shifted row */
                     pl_brick_id(&BRICKS, u + 1.49, v + 1.5, 1));
    assert_int_equal(pl_panel_id(u + 0.01, v, 1), pl_panel_id(u + 0.99, v + 0.99, 1));
    assert_int_not_equal(pl_panel_id(u + 0.5, v, 1), pl_panel_id(u + 0.5, v - 0.01, 1));
  }
}

static void test_checker_and_white_noise(void **state) {
  (void)state;
  test_random random = {44, 0};
  for (int i = 0; i < 24; i++) {
    const double far = i % 2 ? 1e7 : 0.0;
    const pl_vec3 p = {far + sixteenth(&random, -3.0, 3.0), sixteenth(&random, -3.0, 3.0),
                       sixteenth(&random, -3.0, 3.0) - far};
    const double width = eighth_width(&random, i < 12 ? 1.0 : 1.8), low = -0.5 * width;
    const int count = (int)(width / STEP);
    double checker = 0.0, white = 0.0;
    for (int k = 0; k < count * count * count; k++) {
      const pl_vec3 d = {low + (k % count + 0.5) * STEP, low + (k / count % count + 0.5) * STEP,
                         low + (k / count / count + 0.5) * STEP};
      checker += (double)pl_checker(pl_vec3_add(p, d), 0.0f) / (count * count * count);
      white += (double)pl_white_noise(pl_vec3_add(p, d), 0.0f, 7) / (count * count * count);
    }
    assert_true(fabs(checker - (double)pl_checker(p, (float)width)) < 1e-6);
    if (width <= 1.0)
      assert_true(fabs(white - (double)pl_white_noise(p, (float)width, 7)) < 1e-6);
  }
  assert_true(pl_checker(pl_vec3_make(0.5, 0.5, 0.5), 0.0f) == 1.0f);
  assert_true(pl_checker(pl_vec3_make(-0.5, 0.5, 0.5), 0.0f) == 0.0f);
  assert_true(pl_checker(pl_vec3_make(0.3, 0.5, 0.5), INFINITY) == 0.5f);
  /* A plane checker that recedes over 4 octaves: no value leaves the mean by 0.5 % from 8 cells on,
   * and the means of whole pairs of cells are exact. */
  for (float width = 8.0f; width <= 128.0f; width *= 1.03f)
    assert_true(fabsf(pl_checker(pl_vec3_make(0.5, 0.5, 0.5), width) - 0.5f) < 0.0025f);
}

/* Mean 1/2, variance 1/12, neighbours unrelated; continuous in width at 1 and 3 cells. */
static void test_white_noise(void **state) {
  (void)state;
  const int points = 200000;
  test_random random = {45, 0};
  moments m = {0};
  double product = 0.0;
  for (int i = 0; i < points; i++) {
    const pl_vec3 p = random_point(&random, 1e7);
    const double a = (double)pl_white_noise(p, 0.0f, 1);
    const pl_vec3 q = {p.x + 1.0, p.y, p.z};
    moments_add(&m, a);
    product += (a - 0.5) * ((double)pl_white_noise(q, 0.0f, 1) - 0.5) / points;
    const float before = pl_white_noise(p, 0.99999f, 1), after = pl_white_noise(p, 1.00001f, 1);
    assert_true(fabsf(before - after) < 1e-4f);
  }
  assert_true(fabs(moments_mean(&m) - 0.5) < 5.0 / sqrt(12.0 * points));
  assert_true(fabs(12.0 * moments_variance(&m) - 1.0) < 0.01);
  assert_true(fabs(product) < 5.0 / 12.0 / sqrt(points));
  assert_true(fabsf(pl_white_noise(pl_vec3_make(1, 2, 3), 2.999f, 1) - 0.5f) < 1e-4f);
  assert_true(pl_white_noise(pl_vec3_make(1, 2, 3), INFINITY, 1) == 0.5f);
}

/* Against sums of 20000 points: 1e-4 at the jumps of the saw. */
static void test_waves(void **state) {
  (void)state;
  test_random random = {46, 0};
  for (int shape = 0; shape < PL_WAVE_SHAPES; shape++) {
    for (int i = 0; i < 60; i++) {
      const double phase = random_range(&random, -3.0, 3.0) + (i % 2 ? 1e7 : 0.0);
      const double width = random_scale(&random, 0.01, 5.0);
      double mean = 0.0;
      for (int k = 0; k < 20000; k++)
        mean += (double)pl_wave((pl_wave_shape)shape, phase + width * ((k + 0.5) / 20000.0 - 0.5),
                                0.0f) /
                20000.0;
      assert_true(fabs(mean - (double)pl_wave((pl_wave_shape)shape, phase, (float)width)) < 2e-4);
    }
    assert_true(pl_wave((pl_wave_shape)shape, 0.3, INFINITY) == 0.5f);
    assert_true(fabsf(pl_wave((pl_wave_shape)shape, 0.3, 1.0f) - 0.5f) < 1e-6f);
  }
  assert_true(pl_wave(PL_WAVE_SINE, 0.25, 0.0f) == 1.0f);
  assert_true(fabsf(pl_wave(PL_WAVE_SAW, -0.25, 0.0f) - 0.75f) < 1e-6f);
  assert_true(pl_wave(PL_WAVE_TRIANGLE, 7.5, 0.0f) == 1.0f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_plane_boxes),
      cmocka_unit_test(test_plane_means),
      cmocka_unit_test(test_degenerate_panels),
      cmocka_unit_test(test_ids),
      cmocka_unit_test(test_waves),
      cmocka_unit_test(test_checker_and_white_noise),
      cmocka_unit_test(test_white_noise),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
