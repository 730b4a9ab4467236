/* Sampling maps against their densities, bases, and the sRGB curves. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "math/color.h"
#include "math/sampler.h"
#include "math/sampling.h"

#define SAMPLES (1u << 18)
#define CELLS 16

static void stratum(uint32_t i, float out[2]) { pl_sample_2d(i, 77, 0, out); }

/* Chi-square of four samples of each of many seeds on cells that are equally probable by the exact
 * distribution. 255 degrees of freedom: 370 is passed by chance once in 3e6. */
typedef void (*cell_fn)(pl_vec3f d, double out[2]); /* maps to the unit square by the exact cdf */
typedef pl_vec3f (*sample_fn)(float u, float v);

static double chi_square(sample_fn sample, cell_fn cell) {
  static int count[CELLS * CELLS];
  memset(count, 0, sizeof count);
  const double expected = (double)SAMPLES / (CELLS * CELLS);
  for (uint32_t i = 0; i < SAMPLES; i++) {
    float p[2];
    double c[2];
    pl_sample_2d(i & 3u, i >> 2, 5, p);
    cell(sample(p[0], p[1]), c);
    const int x = (int)fmin(c[0] * CELLS, CELLS - 1), y = (int)fmin(c[1] * CELLS, CELLS - 1);
    count[y * CELLS + x]++;
  }
  double chi2 = 0.0;
  for (int i = 0; i < CELLS * CELLS; i++)
    chi2 += (count[i] - expected) * (count[i] - expected) / expected;
  return chi2;
}

static double turn(pl_vec3f d) { return 0.5 + atan2((double)d.y, (double)d.x) / (2.0 * PL_PI); }
static double radius2(pl_vec3f d) { return (double)d.x * (double)d.x + (double)d.y * (double)d.y; }
static void disc_cell(pl_vec3f d, double out[2]) {
  out[0] = turn(d);
  out[1] = radius2(d);
}
static void cosine_cell(pl_vec3f d, double out[2]) { /* cdf of sin^2 = 1 - cos^2 */
  out[0] = turn(d);
  out[1] = 1.0 - (double)d.z * (double)d.z;
}

static void test_disc(void **state) {
  (void)state;
  assert_true(chi_square(pl_sample_disc, disc_cell) < 370.0);
  for (uint32_t i = 0; i < SAMPLES; i++) {
    float p[2];
    stratum(i, p);
    assert_true(radius2(pl_sample_disc(p[0], p[1])) <= 1.0 + 1e-6);
  }
  assert_true(radius2(pl_sample_disc(0.5f, 0.5f)) == 0.0);
}

static void test_cosine_hemisphere(void **state) {
  (void)state;
  assert_true(chi_square(pl_sample_cosine_hemisphere, cosine_cell) < 370.0);
  /* integral of cos over the hemisphere / pdf = pi for every sample */
  for (uint32_t i = 0; i < SAMPLES; i++) {
    float p[2];
    stratum(i, p);
    const pl_vec3f d = pl_sample_cosine_hemisphere(p[0], p[1]);
    assert_true(d.z >= 0.0f && fabsf(pl_vec3f_norm(d) - 1.0f) < 1e-6f);
    if (d.z > 0.0f)
      assert_true(fabsf(d.z / pl_cosine_hemisphere_pdf(d.z) - PL_PI_F) < 1e-5f);
  }
  assert_true(pl_cosine_hemisphere_pdf(-0.5f) == 0.0f);
}

static float cone_width; /* of the cone under test */
static pl_vec3f cone_sample(float u, float v) { return pl_sample_cone(u, v, cone_width); }
/* 1 - cos = sin^2/(1 + cos) keeps the precision that z has lost. */
static double one_minus_cos(pl_vec3f d) {
  return (double)d.z > 0.0 ? radius2(d) / (1.0 + sqrt(1.0 - fmin(1.0, radius2(d))))
                           : 1.0 - (double)d.z;
}
static void cone_cell(pl_vec3f d, double out[2]) {
  out[0] = turn(d);
  out[1] = one_minus_cos(d) / (double)cone_width;
}

/* Half angles from the whole sphere to the sun's disc and far below: the cap's area comes back. */
static void test_cone(void **state) {
  (void)state;
  static const double halves[] = {PL_PI, 1.5, 0.5, 0.0047, 1e-4, 1e-6, 1e-9};
  for (size_t k = 0; k < sizeof halves / sizeof halves[0]; k++) {
    const double exact = 2.0 * pow(sin(0.5 * halves[k]), 2.0);
    cone_width = (float)exact;
    assert_true(fabs((double)pl_cone_pdf(cone_width) * 2.0 * PL_PI * exact - 1.0) < 1e-6);
    if (halves[k] < 1.6)
      assert_true(chi_square(cone_sample, cone_cell) < 370.0);
    double widest = 0.0, mean = 0.0;
    for (uint32_t i = 0; i < SAMPLES; i++) {
      float p[2];
      stratum(i, p);
      const pl_vec3f d = cone_sample(p[0], p[1]);
      assert_true(fabsf(pl_vec3f_norm(d) - 1.0f) < 1e-6f);
      const double width = one_minus_cos(d) / exact;
      widest = fmax(widest, width);
      mean += width / SAMPLES;
    }
    assert_true(widest < 1.0 + 1e-6 && widest > 0.999); /* inside, and filled to the rim */
    assert_true(fabs(mean - 0.5) < 1e-4);               /* 1 - cos is uniform; stratified */
  }
}

static void test_basis(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 100000; i++) {
    float p[2];
    stratum(i, p);
    pl_vec3f n = pl_sample_cone(p[0], p[1], 2.0f);
    if (i < 4) /* the poles, and just off them */
      n = pl_vec3f_unit(pl_vec3f_make(0.0f, i & 1 ? 1e-6f : 0.0f, i & 2 ? -1.0f : 1.0f));
    const pl_basis basis = pl_basis_make(n);
    assert_true(fabsf(pl_vec3f_norm(basis.t) - 1.0f) < 2e-6f);
    assert_true(fabsf(pl_vec3f_norm(basis.b) - 1.0f) < 2e-6f);
    assert_true(fabsf(pl_vec3f_dot(basis.t, basis.b)) < 2e-6f);
    assert_true(fabsf(pl_vec3f_dot(basis.t, n)) < 2e-6f);
    assert_true(pl_vec3f_dot(pl_vec3f_cross(basis.t, basis.b), n) > 0.99999f);
    const pl_vec3f v = {0.3f, -0.5f, 0.7f};
    const pl_vec3f back = pl_basis_to_local(&basis, pl_basis_to_world(&basis, v));
    assert_true(pl_vec3f_norm(pl_vec3f_sub(back, v)) < 2e-6f);
  }
}

static void test_power_heuristic(void **state) {
  (void)state;
  assert_true(pl_power_heuristic(1.0f, 1.0f) == 0.5f);
  assert_true(fabsf(pl_power_heuristic(2.0f, 1.0f) - 0.8f) < 1e-6f);
  assert_true(pl_power_heuristic(0.0f, 1.0f) == 0.0f && pl_power_heuristic(0.0f, 0.0f) == 0.0f);
  assert_true(pl_power_heuristic(INFINITY, 3.0f) == 1.0f);
  assert_true(pl_power_heuristic(3.0f, INFINITY) == 0.0f);
  assert_true(pl_power_heuristic(INFINITY, INFINITY) == 1.0f); /* not NaN */
  assert_true(fabsf(pl_power_heuristic(1e30f, 1e30f) - 0.5f) < 1e-6f);
  for (float a = 1e-10f; a < 1e30f; a *= 7.0f) /* weights of the two strategies add up to 1 */
    assert_true(fabsf(pl_power_heuristic(a, 3.0f) + pl_power_heuristic(3.0f, a) - 1.0f) < 1e-6f);
}

static void test_srgb(void **state) {
  (void)state;
  assert_true(fabsf(pl_srgb_encode(0.18f) - 0.461356f) < 1e-5f); /* 1.055 0.18^(1/2.4) - 0.055 */
  assert_true(fabsf(pl_srgb_decode(0.5f) - 0.2140411f) < 1e-6f);
  assert_true(pl_srgb_encode(0.0f) == 0.0f && fabsf(pl_srgb_encode(1.0f) - 1.0f) < 1e-6f);
  for (int i = 0; i <= 255; i++) { /* every 8-bit value comes back */
    const float round_trip = 255.0f * pl_srgb_encode(pl_srgb_decode((float)i / 255.0f));
    assert_int_equal(lrintf(round_trip), i);
    assert_true(fabsf(round_trip - (float)i) < 1e-3f);
  }
}

/* Of 256 samples a quarter takes the first way. Those of either way are in cells as all of them
 * are: one or three in each, which a choice by a number of its own does not keep. */
static void test_choice_keeps_strata(void **state) {
  (void)state;
  enum { SIDE = 8, COUNT = 4 * SIDE * SIDE };
  for (uint32_t seed = 0; seed < 100; seed++) {
    int below[SIDE][SIDE] = {{0}}, above[SIDE][SIDE] = {{0}};
    for (uint32_t i = 0; i < COUNT; i++) {
      float u[2];
      pl_sample_2d(i, seed, 0, u);
      int(*cells)[SIDE] = pl_sample_choose(0.25f, &u[0]) ? below : above;
      assert_true(u[0] >= 0.0f && u[0] < 1.0f);
      cells[(int)(SIDE * u[1])][(int)(SIDE * u[0])]++;
    }
    for (int k = 0; k < SIDE * SIDE; k++) {
      assert_int_equal(below[k / SIDE][k % SIDE], 1);
      assert_in_range(above[k / SIDE][k % SIDE], 1, 5);
    }
  }
  float most = 0x1.fffffep-1f, same = 0.3f;
  assert_true(!pl_sample_choose(0.7f, &most) && most < 1.0f);
  assert_true(pl_sample_choose(1.0f, &same) && same == 0.3f);
  assert_true(!pl_sample_choose(0.0f, &same) && same == 0.3f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_choice_keeps_strata),
      cmocka_unit_test(test_disc),
      cmocka_unit_test(test_cosine_hemisphere),
      cmocka_unit_test(test_cone),
      cmocka_unit_test(test_basis),
      cmocka_unit_test(test_srgb),
      cmocka_unit_test(test_power_heuristic),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
