/* Fractals: exact moments where there are any, gradients, and means kept by the filter. Random
 * points are drawn from fixed seeds; bounds on statistics lie at five standard errors or more. */
#include "harness.h"
#include "math/fractal.h"
#include "textures.h"

static const pl_fractal SHAPE = {.octaves = 5.0f,
                                 .roughness = 0.55f,
                                 .lacunarity = 2.1f,
                                 .offset = 0.8f,
                                 .gain = 1.6f,
                                 .seed = 3};

static moments over_space(int kind, const pl_fractal *fractal, float width, int points) {
  test_random random = {21, 0};
  moments m = {0};
  for (int i = 0; i < points; i++)
    moments_add(&m,
                (double)pl_fractal_rows[kind].evaluate(fractal, random_point(&random, 1e4), width));
  return m;
}

/* fbm: independent octaves add their variances. multifractal and hetero terrain: means are
 * products, as the octaves are independent and of mean 0. */
static void test_exact_moments(void **state) {
  (void)state;
  double amplitude = 1.0, sum = 0.0, square = 0.0, product = (double)SHAPE.offset;
  for (int i = 0; i < 5; i++) {
    sum += amplitude;
    square += amplitude * amplitude;
    product *= i ? 1.0 + amplitude * (double)SHAPE.offset : 1.0;
    amplitude *= (double)SHAPE.roughness;
  }
  const moments fbm = over_space(PL_FRACTAL_FBM, &SHAPE, 0.0f, 100000);
  const double variance = PL_NOISE_VARIANCE * square / (sum * sum);
  assert_true(fabs(moments_mean(&fbm)) < 5.0 * sqrt(variance / 1e5));
  assert_true(fabs(moments_variance(&fbm) / variance - 1.0) < 0.03);
  const moments multi = over_space(PL_FRACTAL_MULTIFRACTAL, &SHAPE, 0.0f, 100000);
  assert_true(fabs(moments_mean(&multi) - 1.0) < 5.0 * sqrt(moments_variance(&multi) / 1e5));
  const moments hetero = over_space(PL_FRACTAL_HETERO_TERRAIN, &SHAPE, 0.0f, 100000);
  assert_true(fabs(moments_mean(&hetero) - product) < 5.0 * sqrt(moments_variance(&hetero) / 1e5));
  const float at_infinity = pl_fractal_rows[PL_FRACTAL_HETERO_TERRAIN].evaluate(
      &SHAPE, pl_vec3_make(0.1, 0.2, 0.3), INFINITY);
  assert_true(fabs((double)at_infinity / product - 1.0) < 1e-6);
}

/* At every width the mean over space, of the same points, is that of the unfiltered texture within
 * 0.03 standard deviations, and the spread falls until the value is one constant. */
static void test_mean_is_kept(void **state) {
  (void)state;
  static const pl_fractal shapes[] = {
      {.octaves = 5.0f, .roughness = 0.55f, .lacunarity = 2.1f, .offset = 0.8f, .gain = 1.6f},
      {.octaves = 3.5f, .roughness = 0.8f, .lacunarity = 1.7f, .offset = 1.0f, .gain = 2.0f},
      {.octaves = 8.0f, .roughness = 0.3f, .lacunarity = 3.0f, .offset = 0.3f, .gain = 4.0f}};
  for (size_t s = 0; s < sizeof shapes / sizeof shapes[0]; s++)
    for (int kind = 0; kind < PL_FRACTAL_KINDS; kind++) {
      const int points = 30000;
      const moments full = over_space(kind, &shapes[s], 0.0f, points);
      const double sigma = sqrt(moments_variance(&full));
      double before = sigma;
      for (float width = 0.1f; width < 4.0f; width *= 2.3f) {
        const moments m = over_space(kind, &shapes[s], width, points);
        const double spread = sqrt(moments_variance(&m));
        const double bias = (moments_mean(&m) - moments_mean(&full)) / sigma;
        assert_true(fabs(bias) < 0.03);
        assert_true(spread <= before * (1.0 + 1e-6));
        before = spread;
      }
      const moments far = over_space(kind, &shapes[s], PL_NOISE_WIDEST, 50);
      assert_true(moments_variance(&far) <= 1e-12 * moments_mean(&far) * moments_mean(&far));
    }
}

/* The filtered value against the mean over the footprint. */
static void test_footprint(void **state) {
  (void)state;
  static const struct {
    float width;
    double rms; /* of the difference, in standard deviations of the texture */
  } cases[] = {{0.02f, 0.01}, {0.1f, 0.07}, {0.5f, 0.35}, {2.0f, 0.33}, {6.0f, 0.15}};
  for (int kind = 0; kind < PL_FRACTAL_KINDS; kind++) {
    const moments full = over_space(kind, &SHAPE, 0.0f, 20000);
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
      test_random random = {22, 0};
      moments error = {0};
      for (int i = 0; i < 250; i++) {
        const pl_vec3 p = random_point(&random, 1e3);
        const pl_quat axes = random_rotation(&random);
        double mean = 0.0;
        for (int j = 0; j < 400; j++)
          mean += (double)pl_fractal_rows[kind].evaluate(
                      &SHAPE, disc_point(p, axes, (double)cases[k].width, j, 400), 0.0f) /
                  400.0;
        moments_add(&error,
                    (double)pl_fractal_rows[kind].evaluate(&SHAPE, p, cases[k].width) - mean);
      }
      const double rms = sqrt(error.square / error.count / moments_variance(&full));
      assert_true(rms < cases[k].rms);
    }
  }
}

static void test_gradient(void **state) {
  (void)state;
  test_random random = {23, 0};
  for (int i = 0; i < 5000; i++) {
    const pl_vec3 p = random_point(&random, i % 2 ? 1e6 : 10.0);
    const float width = i % 3 ? 0.0f : 0.2f;
    const pl_fractal_value f = pl_fractal_gradient(&SHAPE, p, width);
    const pl_fractal_fn fbm = pl_fractal_rows[PL_FRACTAL_FBM].evaluate;
    assert_true(fabsf(f.value - fbm(&SHAPE, p, width)) < 1e-6f);
    const pl_vec3 d = random_direction(&random);
    const double h = 5e-4;
    const double slope = ((double)fbm(&SHAPE, pl_vec3_madd(p, h, d), width) -
                          (double)fbm(&SHAPE, pl_vec3_madd(p, -h, d), width)) /
                         (2.0 * h);
    assert_true(fabs(slope - pl_vec3_dot(pl_vec3f_to_double(f.gradient), d)) < 3e-3);
  }
  const pl_fractal_value none = pl_fractal_gradient(&SHAPE, pl_vec3_make(1, 2, 3), INFINITY);
  const moments full = over_space(PL_FRACTAL_FBM, &SHAPE, 0.0f, 100000);
  assert_true(none.value == 0.0f && pl_vec3f_norm(none.gradient) == 0.0f);
  assert_true(fabs((double)none.lost_variance / moments_variance(&full) - 1.0) < 0.03);
}

/* Octaves of a point are evaluated side by side from some number on; the sum of them is the same.
 */
static void test_gradients_of_many_octaves(void **state) {
  (void)state;
  test_random random = {24, 0};
  const pl_fractal_row *fbm = &pl_fractal_rows[PL_FRACTAL_FBM];
  for (int i = 0; i < 2000; i++) {
    pl_fractal shape = SHAPE;
    shape.octaves = 1.0f + 0.5f * (float)(i % 32);
    shape.lacunarity = i % 5 ? 2.1f : 0.8f;
    const float width[PL_LANES] = {i % 3 ? 0.0f : 0.02f};
    float value[PL_LANES], slope[3][PL_LANES];
    const pl_vec3 p = random_point(&random, 100.0);
    const pl_point_lanes points = {{{p.x}, {p.y}, {p.z}}};
    fbm->gradient_lanes(&shape, &points, width, value, slope);
    const pl_fractal_value f = pl_fractal_gradient(&shape, p, width[0]);
    const pl_vec3f other = {slope[0][0], slope[1][0], slope[2][0]};
    assert_true(fabsf(f.value - value[0]) < 1e-6f);
    assert_true(pl_vec3f_norm(pl_vec3f_sub(f.gradient, other)) <= 1e-5f * pl_vec3f_norm(other));
  }
}

/* Values move continuously with the number of octaves; out of range it is clamped; no lattice point
 * is a zero; nothing is infinite at places that are not. */
static void test_octaves(void **state) {
  (void)state;
  const pl_vec3 p = {0.3, -7.4, 1e7 + 0.2};
  for (int kind = 0; kind < PL_FRACTAL_KINDS; kind++) {
    const pl_fractal_fn evaluate = pl_fractal_rows[kind].evaluate;
    pl_fractal a = SHAPE, b = SHAPE;
    a.octaves = 3.00001f;
    b.octaves = 2.99999f;
    assert_true(fabsf(evaluate(&a, p, 0.0f) - evaluate(&b, p, 0.0f)) < 1e-4f);
    a.octaves = 1e9f;
    b.octaves = PL_FRACTAL_OCTAVES;
    assert_true(evaluate(&a, p, 0.0f) == evaluate(&b, p, 0.0f));
    a.octaves = NAN;
    b.octaves = 1.0f;
    assert_true(evaluate(&a, p, 0.0f) == evaluate(&b, p, 0.0f));
    assert_true(isfinite(evaluate(&SHAPE, pl_vec3_make(NAN, 1e300, -INFINITY), 0.0f)));
    assert_true(evaluate(&SHAPE, p, 0.1f) == evaluate(&SHAPE, p, 0.1f));
  }
  pl_fractal single = SHAPE;
  single.octaves = 1.0f;
  assert_true(pl_fractal_rows[PL_FRACTAL_FBM].evaluate(&single, pl_vec3_make(1, 2, 3), 0.0f) != 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      converging_unit_test(test_exact_moments),
      converging_unit_test(test_mean_is_kept),
      converging_unit_test(test_footprint),
      cmocka_unit_test(test_gradient),
      cmocka_unit_test(test_gradients_of_many_octaves),
      cmocka_unit_test(test_octaves),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
