/* Gradient noise: exact moments, smoothness, isotropy, far coordinates, and its filter. Random
 * points are drawn from fixed seeds, so that bounds on statistics fail always or never; they lie at
 * five standard errors or more. */
#include <string.h>

#include "harness.h"
#include "math/lattice.h"
#include "math/noise.h"
#include "textures.h"

#define POINTS 200000

static void test_moments_and_range(void **state) {
  (void)state;
  static const double extents[] = {4.0, 1e4, 1e7};
  for (size_t k = 0; k < 3; k++) {
    test_random random = {11 + k, 0};
    moments m = {0};
    for (int i = 0; i < POINTS; i++) {
      /* a new seed each time: in few cells one pattern has a mean of its own */
      const double n = (double)pl_noise(random_point(&random, extents[k]), (uint32_t)i);
      assert_true(fabs(n) <= 1.0);
      moments_add(&m, n);
    }
    assert_true(fabs(moments_mean(&m)) < 5.0 * sqrt(PL_NOISE_VARIANCE / POINTS));
    assert_true(fabs(moments_variance(&m) / PL_NOISE_VARIANCE - 1.0) < 0.02);
  }
}

/* The value and the gradient on both sides of a face agree, at either sign and far away. */
static void test_continuity(void **state) {
  (void)state;
  test_random random = {12, 0};
  for (int i = 0; i < 30000; i++) {
    const double face = (double)((int)random_range(&random, -5.0, 5.0)) * (i % 3 == 0 ? 2e6 : 1.0);
    pl_vec3 below = random_point(&random, 5.0), above = below;
    double *const low[3] = {&below.x, &below.y, &below.z};
    double *const high[3] = {&above.x, &above.y, &above.z};
    *low[i % 3] = nextafter(face, -INFINITY);
    *high[i % 3] = face;
    const pl_noise_value a = pl_noise_gradient(below, 1), b = pl_noise_gradient(above, 1);
    assert_true(fabsf(a.value - b.value) < 1e-6f);
    assert_true(pl_vec3f_norm(pl_vec3f_sub(a.gradient, b.gradient)) < 1e-5f);
  }
  for (int i = -3; i < 4; i++) /* lattice points are zeros */
    assert_true(pl_noise(pl_vec3_make(i, 1e7 + i, -i), 5) == 0.0f);
}

/* Central differences over 4e-3 cells; rounding of the float values leaves up to 4e-4. */
static void test_gradient(void **state) {
  (void)state;
  static const double extents[] = {10.0, 1e7};
  for (size_t k = 0; k < 2; k++) {
    test_random random = {13, 0};
    double worst = 0.0;
    for (int i = 0; i < 20000; i++) {
      const pl_vec3 p = random_point(&random, extents[k]);
      const pl_noise_value n = pl_noise_gradient(p, 3);
      assert_true(n.value == pl_noise(p, 3));
      const double h = 2e-3,
                   slopes[3] = {(double)n.gradient.x, (double)n.gradient.y, (double)n.gradient.z};
      for (int axis = 0; axis < 3; axis++) {
        const pl_vec3 d = {axis == 0 ? h : 0.0, axis == 1 ? h : 0.0, axis == 2 ? h : 0.0};
        const double up = (double)pl_noise(pl_vec3_add(p, d), 3);
        const double down = (double)pl_noise(pl_vec3_sub(p, d), 3);
        worst = fmax(worst, fabs((up - down) / (2.0 * h) - slopes[axis]));
      }
    }
    assert_true(worst < 1e-3);
  }
}

/* Mean square of the difference over a distance, along directions of one kind. */
static double structure(pl_vec3 direction, double distance) {
  test_random random = {14, 0};
  moments m = {0};
  const pl_vec3 step = pl_vec3_scale(pl_vec3_unit(direction), distance);
  for (int i = 0; i < POINTS; i++) {
    const pl_vec3 p = random_point(&random, 1e4);
    moments_add(&m, (double)(pl_noise(pl_vec3_add(p, step), 2) - pl_noise(p, 2)));
  }
  return m.square / m.count;
}

/* No direction is preferred where the lattice itself does not say so: the slopes' moments are those
 * of a sphere; over a quarter and half a cell, diagonals and axes differ by less than 4 %. */
static void test_isotropy(void **state) {
  (void)state;
  test_random random = {15, 0};
  double moment[3][3] = {{0}}, mean[3] = {0};
  for (int i = 0; i < POINTS; i++) {
    const pl_vec3f g = pl_noise_gradient(random_point(&random, 1e4), 2).gradient;
    const double v[3] = {(double)g.x, (double)g.y, (double)g.z};
    for (int a = 0; a < 3; a++) {
      mean[a] += v[a] / POINTS;
      for (int b = 0; b < 3; b++)
        moment[a][b] += v[a] * v[b] / POINTS;
    }
  }
  const double trace = (moment[0][0] + moment[1][1] + moment[2][2]) / 3.0;
  for (int a = 0; a < 3; a++) {
    assert_true(fabs(mean[a]) < 5.0 * sqrt(trace / POINTS));
    for (int b = 0; b < 3; b++)
      assert_true(fabs(moment[a][b] / trace - (a == b ? 1.0 : 0.0)) < 0.02);
  }
  for (double distance = 0.25; distance < 0.6; distance += 0.25) {
    const double along = structure(pl_vec3_make(1, 0, 0), distance);
    assert_true(fabs(structure(pl_vec3_make(1, -1, 0), distance) / along - 1.0) < 0.04);
    assert_true(fabs(structure(pl_vec3_make(1, 1, 1), distance) / along - 1.0) < 0.04);
    assert_true(fabs(structure(pl_vec3_make(0, 1, 0), distance) / along - 1.0) < 0.02);
  }
}

/* The faded noise against the mean over discs in random planes, in standard deviations. The bounds
 * are those that noise.c states, and what is said to be missed is about right. */
static void test_filter(void **state) {
  (void)state;
  static const struct {
    double width, rms;
  } cases[] = {{0.1, 0.02}, {0.3, 0.05}, {1.0, 0.27}, {2.0, 0.36}, {3.0, 0.30}, {8.0, 0.12}};
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
    test_random random = {16, 0};
    moments error = {0};
    for (int i = 0; i < 2000; i++) {
      const pl_vec3 p = random_point(&random, 1e3);
      const pl_quat axes = random_rotation(&random);
      double mean = 0.0;
      for (int j = 0; j < 256; j++)
        mean += (double)pl_noise(disc_point(p, axes, cases[k].width, j, 256), 4) / 256.0;
      const double faded = (double)(pl_noise_fade((float)cases[k].width) * pl_noise(p, 4));
      moments_add(&error, (faded - mean) / sqrt(PL_NOISE_VARIANCE));
    }
    const double rms = sqrt(error.square / error.count);
    assert_true(rms < cases[k].rms);
    assert_true(fabs(rms - (double)pl_noise_missed((float)cases[k].width)) < 0.05);
  }
  assert_true(pl_noise_fade(0.0f) == 1.0f && pl_noise_fade(PL_NOISE_WIDEST) == 0.0f);
  assert_true(pl_noise_fade(INFINITY) == 0.0f && pl_noise_fade(NAN) == 0.0f);
  for (float w = 0.0f; w < 4.0f; w += 0.01f)
    assert_true(pl_noise_fade(w + 0.01f) <= pl_noise_fade(w));
}

/* Patterns repeat after 2^32 cells, bit for bit; so do two calls; seeds are unrelated. */
static void test_lattice(void **state) {
  (void)state;
  test_random random = {17, 0};
  double product = 0.0;
  for (int i = 0; i < POINTS; i++) {
    pl_vec3 p = random_point(&random, 1e3);
    p.x = rint(p.x * 0x1p16) * 0x1p-16; /* so that the sum is exact */
    const pl_vec3 q = {p.x + 0x1p32, p.y, p.z};
    const float a = pl_noise(p, 8), b = pl_noise(q, 8);
    assert_memory_equal(&a, &b, sizeof a);
    product += (double)(a * pl_noise(p, 9)) / POINTS;
  }
  assert_true(fabs(product) < 5.0 * PL_NOISE_VARIANCE / sqrt(POINTS));
  assert_true(isfinite(pl_noise(pl_vec3_make(NAN, INFINITY, -1e300), 1)));
  double rest;
  assert_true(pl_lattice_floor(-0.25, &rest) == -1 && rest == 0.75);
  assert_true(pl_lattice_floor(-3.0, &rest) == -3 && rest == 0.0);
  assert_true(pl_lattice_floor(1e7 + 0.5, &rest) == 10000000 && rest == 0.5);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_moments_and_range),
      cmocka_unit_test(test_continuity),
      cmocka_unit_test(test_gradient),
      cmocka_unit_test(test_isotropy),
      cmocka_unit_test(test_filter),
      cmocka_unit_test(test_lattice),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
