/* The row of open water: Cox and Munk's formula of glint, energy, reciprocity, bounds, sampling. */
#include "harness.h"

#include <math.h>

#include "shade/water.h"
#include "surfaces.h"

static const float winds[] = {0.0f, 2.0f, 7.0f, 14.0f, 40.0f};

static pl_surface sea(float wind, float color, float water) {
  pl_surface s = white(pl_water_alpha(wind), 0.0f);
  s.color = pl_vec3f_make(color, color, color);
  s.water = water;
  s.below = pl_vec3f_scale(s.color, water);
  return s;
}

/* Fresnel's equations as in textbooks, with Snell's law in angles. */
static double fresnel(double cosine) {
  const double i = acos(fmin(1.0, cosine)), t = asin(sin(i) / 1.34);
  if (i < 1e-6)
    return pow(0.34 / 2.34, 2.0);
  const double s = sin(i - t) / sin(i + t), p = tan(i - t) / tan(i + t);
  return 0.5 * (s * s + p * p);
}

/* Cox and Munk 1954: of slopes with the variance s2 (both axes), radiance over irradiance is
 * F p(slope) / (4 cos(view) cos^4(tilt)). Nothing there hides one wave behind another: steep
 * directions only. */
static void test_is_the_formula_of_cox_and_munk(void **state) {
  (void)state;
  test_random random = {.seed = 61};
  for (int i = 0; i < 20000; i++) {
    const float wind = winds[random_below(&random, 4)];
    const double s2 = 0.003 + 0.00512 * (double)wind;
    const pl_surface s = sea(wind, 0.0f, 1.0f);
    const pl_vec3f wo = tilted((float)random_range(&random, 0.75, 1.0), 0.3f);
    const pl_vec3f wi = tilted((float)random_range(&random, 0.75, 1.0),
                               (float)random_range(&random, -PL_PI, PL_PI));
    const pl_vec3 h = pl_vec3_unit(pl_vec3f_to_double(pl_vec3f_add(wo, wi)));
    const double tan2 = (h.x * h.x + h.y * h.y) / (h.z * h.z);
    const double p = exp(-tan2 / s2) / (PL_PI * s2);
    const double expected =
        fresnel(pl_vec3_dot(h, pl_vec3f_to_double(wo))) * p / (4.0 * (double)wo.z * pow(h.z, 4.0));
    const double found = (double)pl_reflectance_water.evaluate(&s, wo, wi).x;
    assert_true(fabs(found - expected) <= 2e-3 * expected + 1e-9);
  }
}

static void test_dry_ground_is_lambert(void **state) {
  (void)state;
  const pl_surface s = sea(7.0f, 0.3f, 0.0f);
  const pl_vec3f wo = tilted(0.4f, 0.0f), wi = tilted(0.7f, 2.0f);
  const float found = pl_reflectance_water.evaluate(&s, wo, wi).x;
  assert_true(fabsf(found - pl_reflectance_lambert.evaluate(&s, wo, wi).x) < 1e-6f);
  assert_true(fabsf(pl_reflectance_water.under_sky(&s, wo).x - 0.3f) < 1e-6f);
}

static void test_reciprocity(void **state) {
  (void)state;
  test_random random = {.seed = 62};
  for (int i = 0; i < 50000; i++) {
    const pl_surface s = sea(winds[random_below(&random, 5)], 0.2f, (float)random_unit(&random));
    const pl_vec3f a = tilted((float)random_range(&random, 0.01, 1), 0.0f);
    const pl_vec3f b =
        tilted((float)random_range(&random, 0.01, 1), (float)random_range(&random, -PL_PI, PL_PI));
    const float there = pl_reflectance_water.evaluate(&s, a, b).x / b.z;
    const float back = pl_reflectance_water.evaluate(&s, b, a).x / a.z;
    assert_true(fabsf(there - back) <= 1e-4f * fmaxf(there, back) + 1e-12f);
  }
}

/* What the bound of the row and pl_view_transfer rest on. */
static void test_bound_of_the_lobe(void **state) {
  (void)state;
  test_random random = {.seed = 63};
  double nearest = 0.0;
  for (int i = 0; i < 300000; i++) {
    const float wind = (float)random_range(&random, 0.0, 40.0);
    const pl_surface s = sea(wind, 1.0f, 1.0f);
    const double alpha = (double)s.alpha, bound = pow((double)pl_water_bound_alpha(wind), -3.0);
    const pl_vec3f wo = tilted((float)random_scale(&random, 1e-3, 1), 0.0f);
    const pl_vec3f wi = tilted((float)random_scale(&random, 1e-3, 1),
                               (float)(PL_PI + alpha * random_range(&random, -3, 3)));
    const double value = PL_PI * (double)pl_reflectance_water.evaluate(&s, wo, wi).x;
    nearest = fmax(nearest, value / (0.5 * bound));
  }
  print_message("seed 63: the bound is used up to %.3f\n", nearest);
  assert_true(nearest > 0.8 && nearest < 1.0);
}

enum { DRAWS = 1 << 15 };

/* Draws, the integral over the hemisphere, and what an even sky is said to give: all the same, and
 * no more than comes in. (At grazing angles the lobe is narrower than the steps of the integral.) A
 * draw's weight stays small. */
static void test_energy(void **state) {
  (void)state;
  test_random random = {.seed = 64};
  double worst = 0.0, heaviest = 0.0, most = 0.0;
  for (size_t w = 0; w < COUNT(winds); w++)
    for (size_t c = 0; c < 4; c++)
      for (int bright = 0; bright < 2; bright++) {
        const sight seen = {&pl_reflectance_water, "sea", sea(winds[w], (float)bright, 1.0f),
                            tilted(cosines[c], 0.4f)};
        double drawn = 0.0, even = 0.0;
        for (int i = 0; i < DRAWS; i++) {
          pl_vec3f wi, weight;
          float pdf;
          if (draw(&seen, &random, &wi, &weight, &pdf)) {
            drawn += (double)weight.x / DRAWS;
            heaviest = fmax(heaviest, (double)weight.x);
            assert_true(fabsf(pdf - seen.model->pdf(&seen.surface, seen.wo, wi)) <= 1e-3f * pdf);
          }
          wi = tilted(((float)(i / 128) + 0.5f) / (DRAWS / 128),
                      2.0f * PL_PI_F * ((float)(i % 128) + 0.5f) / 128.0f);
          even += 2.0 * PL_PI * (double)seen.model->evaluate(&seen.surface, seen.wo, wi).x / DRAWS;
        }
        const double said = (double)seen.model->under_sky(&seen.surface, seen.wo).x;
        most = fmax(most, drawn);
        worst = fmax(worst, fabs(said - drawn));
        if (drawn > 1.0 || fabs(said - drawn) > 0.1 || (c < 3 && fabs(even - drawn) > 0.01))
          fail_msg("wind %g cosine %g colour %d: %.4f drawn, %.4f even, %.4f said\n",
                   (double)winds[w], (double)cosines[c], bright, drawn, even, said);
      }
  print_message("seed 64: reflects at most %.3f, sky off by %.3f, heaviest weight %.2f\n", most,
                worst, heaviest);
  assert_true(heaviest < 8.0);
}

static void test_extremes_are_finite(void **state) {
  (void)state;
  const float grazing[] = {1.0f, 0.5f, 1e-3f, 1e-7f, 1e-20f, 1e-40f};
  for (size_t w = 0; w < COUNT(winds); w++)
    for (size_t i = 0; i < COUNT(grazing); i++)
      for (size_t k = 0; k < COUNT(grazing); k++)
        for (int turn = 0; turn < 4; turn++) {
          const pl_surface s = sea(winds[w], 0.5f, 1.0f);
          const pl_vec3f wo = tilted(grazing[i], 0.0f);
          const pl_vec3f wi = tilted(grazing[k], 0.5f * PL_PI_F * (float)turn);
          const float value = pl_reflectance_water.evaluate(&s, wo, wi).x;
          assert_true(isfinite(value) && value >= 0.0f);
          assert_true(isfinite(pl_reflectance_water.pdf(&s, wo, wi)));
        }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_is_the_formula_of_cox_and_munk),
      cmocka_unit_test(test_dry_ground_is_lambert),
      cmocka_unit_test(test_reciprocity),
      cmocka_unit_test(test_bound_of_the_lobe),
      cmocka_unit_test(test_energy),
      cmocka_unit_test(test_extremes_are_finite),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
