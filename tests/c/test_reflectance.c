/* Rows of the table of reflectance models: white furnaces, reciprocity, bounds, extreme angles and
 * roughness. Sampling, weights and energy: test_reflectance_sampling. */
#include "harness.h"

#include <stdio.h>
#include <string.h>

#include "math/sampler.h"
#include "surfaces.h"

static const float alphas[] = {0.0f, 1e-3f, 0.02f, 0.1f, 0.3f, 0.6f, 1.0f};

static void test_lambert_energy_is_albedo(void **state) {
  (void)state;
  pl_surface surface = white(1.0f, 0.0f);
  surface.color = pl_vec3f_make(0.1f, 0.5f, 1.0f);
  const pl_vec3f up = pl_vec3f_make(0.0f, 0.0f, 1.0f);
  const pl_vec3f value = pl_reflectance_lambert.evaluate(&surface, up, up);
  assert_true(fabsf(value.x * PL_PI_F - 0.1f) < 1e-6f && fabsf(value.z * PL_PI_F - 1.0f) < 1e-6f);
}

/* --- the white furnace ------------------------------------------------------------------------ */

enum { FURNACE_DRAWS = PL_DRAWS(1 << 14, 1 << 12) };
static const double FURNACE_ERROR = PL_DRAWS(0.005, 0.015);

/* Light reflected under a white sky, by stratified draws: in [0] the draws of `sample`, in [1] the
 * integral of `evaluate` over the hemisphere, to which sampling contributes nothing. */
static void furnace(const pl_reflectance *model, const pl_surface *surface, pl_vec3f wo,
                    double out[2]) {
  out[0] = out[1] = 0.0;
  for (uint32_t i = 0; i < FURNACE_DRAWS; i++) {
    float u[2], pdf;
    pl_vec3f wi, weight;
    pl_sample_2d(i, 26, 0, u);
    if (model->sample(surface, wo, u, &wi, &weight, &pdf))
      out[0] += (double)weight.x / FURNACE_DRAWS;
    wi = pl_sample_cosine_hemisphere(u[0], u[1]);
    if (wi.z > 0.0f)
      out[1] += (double)(model->evaluate(surface, wo, wi).x / pl_cosine_hemisphere_pdf(wi.z)) /
                FURNACE_DRAWS;
  }
}

/* A white surface, metal, dielectric or half of each, returns all light: within 0.005 for views up
 * to 85 deg from the normal. The integral without sampling is looked at where lobes are broad. */
static void test_white_furnace(void **state) {
  (void)state;
  double worst = 0.0, worst_flat = 0.0;
  for (int r = 1; r <= 20; r += PL_DRAWS(1, 3))
    for (int degrees = 0; degrees <= 85; degrees += 5) {
      const float roughness = 0.05f * (float)r;
      const pl_surface metal = white(roughness * roughness, 1.0f);
      const pl_vec3f wo = tilted(cosf((float)degrees * PL_PI_F / 180.0f), 0.4f);
      double energy[2];
      for (int half = 0; half < 2 && degrees % 10 == 5; half++) {
        const pl_surface paint = white(roughness * roughness, half ? 0.5f : 0.0f);
        furnace(&pl_reflectance_metallic_roughness, &paint, wo, energy);
        if (fabs(energy[0] - 1.0) > FURNACE_ERROR)
          fail_msg("roughness %g, metallic %g at %d deg reflects %.4f", (double)roughness,
                   (double)paint.metallic, degrees, energy[0]);
      }
      furnace(&pl_reflectance_metallic_roughness, &metal, wo, energy);
      if (fabs(energy[0] - 1.0) > FURNACE_ERROR)
        fail_msg("roughness %g at %d deg reflects %.4f", (double)roughness, degrees, energy[0]);
      worst = fmax(worst, fabs(energy[0] - 1.0));
      if (roughness > 0.65f)
        worst_flat = fmax(worst_flat, fabs(energy[1] - 1.0));
      furnace(&pl_reflectance_lambert, &metal, wo, energy);
      assert_true(fabs(energy[0] - 1.0) < 1e-5 && fabs(energy[1] - 1.0) < 1e-5);
    }
  print_message("white GGX furnace: off by at most %.4f sampled, %.4f integrated\n", worst,
                worst_flat);
  assert_true(worst_flat < FURNACE_ERROR);
}

/* Albedos under a white sky at 0, 40, 60 and 70 degrees, of Cycles 4.5.15's Principled of
 * index 1.5: a ball of 720 by 360 facets, by 512 samples a pixel, which are good to 0.002. */
static void test_same_albedo_as_cycles(void **state) {
  (void)state;
  static const struct {
    float color, roughness;
    double albedo[4];
  } cycles[] = {
      {0.0f, 0.1f, {0.040, 0.046, 0.090, 0.173}}, {0.0f, 0.3f, {0.040, 0.046, 0.087, 0.153}},
      {0.0f, 0.5f, {0.037, 0.043, 0.068, 0.097}}, {0.0f, 0.7f, {0.029, 0.033, 0.046, 0.060}},
      {0.0f, 1.0f, {0.014, 0.017, 0.025, 0.033}}, {0.2f, 0.1f, {0.232, 0.237, 0.272, 0.339}},
      {0.2f, 0.3f, {0.232, 0.237, 0.270, 0.323}}, {0.2f, 0.5f, {0.230, 0.235, 0.254, 0.277}},
      {0.2f, 0.7f, {0.223, 0.227, 0.236, 0.248}}, {0.2f, 1.0f, {0.211, 0.214, 0.220, 0.226}},
      {0.8f, 0.1f, {0.808, 0.809, 0.818, 0.834}}, {0.8f, 0.3f, {0.808, 0.809, 0.818, 0.831}},
      {0.8f, 0.5f, {0.807, 0.808, 0.812, 0.816}}, {0.8f, 0.7f, {0.806, 0.806, 0.808, 0.810}},
      {0.8f, 1.0f, {0.804, 0.804, 0.805, 0.806}},
  };
  static const float degrees[] = {0.0f, 40.0f, 60.0f, 70.0f};
  double worst = 0.0;
  for (size_t i = 0; i < COUNT(cycles); i++) {
    pl_surface paint = white(cycles[i].roughness * cycles[i].roughness, 0.0f);
    const float c = cycles[i].color;
    paint.color = pl_vec3f_make(c, c, c);
    for (size_t k = 0; k < COUNT(degrees); k++) {
      double energy[2];
      furnace(&pl_reflectance_metallic_roughness, &paint,
              tilted(cosf(degrees[k] * PL_PI_F / 180.0f), 0.4f), energy);
      const double off = fabs(energy[0] - cycles[i].albedo[k]);
      if (off > 0.005)
        fail_msg("colour %g, roughness %g at %g deg: %.4f, not %.3f", (double)c,
                 (double)cycles[i].roughness, (double)degrees[k], energy[0], cycles[i].albedo[k]);
      worst = fmax(worst, off);
    }
  }
  print_message("albedos of Cycles: off by at most %.4f\n", worst);
}

/* Multiple reflection deepens a metal's colour: each hit takes its part. */
static void test_rough_metal_is_more_saturated(void **state) {
  (void)state;
  pl_surface gold = white(1.0f, 1.0f);
  gold.color = pl_vec3f_make(1.0f, 0.7f, 0.3f);
  const pl_vec3f wo = tilted(0.8f, 0.0f), wi = tilted(0.6f, 2.0f);
  const pl_vec3f value = pl_reflectance_metallic_roughness.evaluate(&gold, wo, wi);
  assert_true(value.y < 0.7f * value.x && value.z < 0.3f * value.x);
}

/* A smooth metal loses nothing. */
static void test_smooth_metal_is_a_mirror(void **state) {
  (void)state;
  const pl_surface surface = white(1e-3f, 1.0f);
  double energy[2];
  furnace(&pl_reflectance_metallic_roughness, &surface, tilted(0.7f, 0.0f), energy);
  assert_true(fabs(energy[0] - 1.0) < 1e-3);
}

/* --- reciprocity, bounds, extremes ------------------------------------------------------------ */

/* Any surface that the model takes, but for coats with a normal of their own and solids: bent
 * normals are not reciprocal, and the way back through a boundary starts on its other side. */
static pl_surface any_surface(const pl_reflectance *model, test_random *random) {
  if (model->photometric)
    return ground_of(&grounds[random_below(random, COUNT(grounds))]);
  const float alpha = alphas[1 + random_below(random, COUNT(alphas) - 1)];
  pl_surface s = with(white(alpha, (float)random_unit(random)),
                      &variants[random_below(random, COUNT(variants))]);
  s.lobes.coat_normal = pl_vec3f_make(0.0f, 0.0f, 0.0f);
  s.lobes.ior = 0.0f;
  s.lobes.inside = false;
  return s;
}

static void test_reciprocity(void **state) {
  (void)state;
  test_random random = {.seed = 24};
  for (size_t m = 0; m < pl_reflectance_count; m++) {
    for (int i = 0; i < PL_DRAWS(100000, 10000); i++) {
      const pl_surface s = any_surface(pl_reflectances[m], &random);
      const pl_vec3f a = tilted((float)random_range(&random, 0.01, 1), 0.0f);
      const pl_vec3f b = tilted((float)random_range(&random, 0.01, 1),
                                (float)random_range(&random, -PL_PI, PL_PI));
      const float there = pl_reflectances[m]->evaluate(&s, a, b).x / b.z;
      const float back = pl_reflectances[m]->evaluate(&s, b, a).x / a.z;
      assert_true(fabsf(there - back) <= 1e-4f * fmaxf(there, back));
      const float out = pl_reflectances[m]->evaluate(&s, a, turned_over(b)).x / b.z;
      const float in = pl_reflectances[m]->evaluate(&s, b, turned_over(a)).x / a.z;
      assert_true(fabsf(out - in) <= 1e-4f * fmaxf(out, in));
      assert_true((out > 0.0f) == (pl_reflectances[m]->layered && s.lobes.transmission > 0.0f));
    }
  }
}

/* What passes the boundary of a solid one way, of radiance as in vacuum, passes it the other way
 * but for the square of the index (Walter et al. 2007, appendix). */
static void test_reciprocity_of_boundaries(void **state) {
  (void)state;
  test_random random = {.seed = 27};
  int passed = 0;
  for (int i = 0; i < PL_DRAWS(100000, 10000); i++) {
    pl_surface s = white((float)random_scale(&random, 0.02, 1.0), 0.0f);
    s.lobes = (pl_lobes){.transmission = 1.0f, .ior = (float)random_range(&random, 1.1, 2.5)};
    const pl_vec3f a = tilted((float)random_range(&random, 0.01, 1), 0.0f);
    const pl_vec3f b =
        tilted((float)random_range(&random, 0.01, 1), (float)random_range(&random, -PL_PI, PL_PI));
    const float in = pl_reflectance_principled.evaluate(&s, a, turned_over(b)).x / b.z;
    s.lobes.inside = true;
    const float back = pl_reflectance_principled.evaluate(&s, b, turned_over(a)).x / a.z;
    assert_true(fabsf(in - s.lobes.ior * s.lobes.ior * back) <= 1e-2f * in + 2e-5f);
    passed += in > 0.0f;
  }
  assert_true(passed > 1000);
}

/* What the plan's bounds rest on: pi f cos <= max(1, 1/(2 alpha^3)), but for what rough metals
 * reflect several times: at alpha = 1 and normal incidence 0.25 by one reflection and 0.8 more. */
static void test_bound_of_the_lobe(void **state) {
  (void)state;
  test_random random = {.seed = 25};
  double nearest = 0.0;
  for (size_t m = 0; m < pl_reflectance_count; m++) {
    for (int i = 0; i < PL_DRAWS(300000, 20000); i++) {
      const double alpha = random_scale(&random, 0.03, 1.0);
      const variant *v = &variants[random_below(&random, 6)]; /* one lobe */
      const pl_surface s = with(white((float)alpha, (float)random_unit(&random)), v);
      const pl_vec3f wo = tilted((float)random_scale(&random, 1e-3, 1), 0.0f);
      const pl_vec3f wi = tilted((float)random_scale(&random, 1e-3, 1),
                                 (float)(PL_PI + alpha * random_range(&random, -3, 3)));
      const double value =
          PL_PI * shade_of(pl_reflectances[m]) * (double)pl_reflectances[m]->evaluate(&s, wo, wi).x;
      const double bound = fmax(1.06, 0.5 / (alpha * alpha * alpha)); /* gain() of plan/view.c */
      if (value > bound * (1.0 + 1e-5))
        fail_msg("%s %s alpha %g metallic %g: %g over %g", pl_reflectances[m]->name, v->name, alpha,
                 (double)s.metallic, value, bound);
      nearest = fmax(nearest, value / bound);
    }
  }
  print_message("seed 25: the bound is used up to %.3f\n", nearest);
  assert_true(nearest > 0.5);
}

/* Densities of draws stay below their bound, which GGX uses up where it is looked at at a grazing
 * angle. Half of the draws are about the mirror's direction. */
static void test_bound_of_the_density(void **state) {
  (void)state;
  test_random random = {.seed = 26};
  double nearest = 0.0;
  for (size_t m = 0; m < pl_reflectance_count; m++)
    for (int i = 0; i < PL_DRAWS(300000, 20000); i++) {
      const double alpha = random_scale(&random, 0.01, 1.0);
      pl_surface s = white((float)alpha, (float)random_unit(&random));
      s.reflectance = pl_reflectances[m];
      const double spread = i % 2 == 0 ? alpha : 1.0;
      const float cosine = (float)random_scale(&random, 1e-3, 1);
      const pl_vec3f wo = tilted(cosine, 0.0f);
      const double bound = (double)pl_surface_pdf_most(&s, wo);
      const pl_vec3f wi = tilted(i % 4 == 0 ? cosine : (float)random_scale(&random, 1e-3, 1),
                                 (float)(PL_PI + spread * random_range(&random, -3, 3)));
      if (s.reflectance->pdf_most == NULL)
        continue;
      const double density = (double)s.reflectance->pdf(&s, wo, wi);
      if (density > bound * (1.0 + 1e-5))
        fail_msg("%s alpha %g: %g over %g", s.reflectance->name, alpha, density, bound);
      nearest = fmax(nearest, s.reflectance == &pl_reflectance_metallic_roughness && alpha < 0.1
                                  ? density / bound
                                  : 0.0);
    }
  print_message("seed 26: GGX uses up to %.3f of the bound\n", nearest);
  assert_true(nearest > 0.2);
}

static bool sound(pl_vec3f v) {
  return isfinite(v.x) && isfinite(v.y) && isfinite(v.z) && v.x >= 0.0f && v.y >= 0.0f &&
         v.z >= 0.0f;
}

static const float grazing[] = {1.0f, 0.5f, 1e-2f, 1e-3f, 1e-5f, 1e-7f, 1e-20f, 1e-40f};

static void check_extremes(const pl_reflectance *model, const pl_surface *s, pl_vec3f wo) {
  const float corner[] = {0.0f, 0x1p-24f, 0.5f, 1.0f - 0x1p-24f};
  for (size_t i = 0; i < COUNT(grazing); i++)
    for (int turn = 0; turn < 16; turn++) {
      const pl_vec3f over = tilted(grazing[i], 1.0f + (float)turn * PL_PI_F / 4.0f);
      const pl_vec3f wi = turn < 8 ? over : turned_over(over);
      const float pdf = model->pdf(s, wo, wi);
      assert_true(sound(model->evaluate(s, wo, wi)));
      assert_true(isfinite(pdf) && pdf >= 0.0f);
    }
  for (int i = 0; i < 16; i++) {
    const float u[2] = {corner[i & 3], corner[i >> 2 & 3]};
    pl_vec3f wi, weight;
    float pdf;
    if (!model->sample(s, wo, u, &wi, &weight, &pdf))
      continue;
    assert_true(sound(weight) && isfinite(pdf) && pdf > 0.0f);
    assert_true(isfinite(wi.x) && isfinite(wi.y) && isfinite(wi.z));
  }
}

/* White and black surfaces. */
static void test_extremes(void **state) {
  (void)state;
  for (size_t m = 0; m < pl_reflectance_count; m++)
    for (size_t a = 0; a < COUNT(alphas); a++)
      for (size_t k = 0; k < COUNT(metals); k++)
        for (size_t c = 0; c < COUNT(grazing); c++)
          for (size_t v = 0; v < COUNT(variants); v++) {
            pl_surface s = pl_reflectances[m]->photometric
                               ? ground_of(&grounds[v % COUNT(grounds)])
                               : with(white(alphas[a], metals[k]), &variants[v]);
            check_extremes(pl_reflectances[m], &s, tilted(grazing[c], 1.0f));
            s.color = pl_vec3f_make(0.0f, 0.0f, 0.0f);
            check_extremes(pl_reflectances[m], &s, tilted(grazing[c], 1.0f));
          }
}

static void test_below_the_horizon(void **state) {
  (void)state;
  const pl_surface s = white(0.3f, 0.5f);
  for (size_t m = 0; m < pl_reflectance_count; m++) {
    const pl_vec3f down = tilted(-0.3f, 2.0f), up = tilted(0.5f, 0.0f);
    assert_true(pl_reflectances[m]->evaluate(&s, up, down).x == 0.0f);
    assert_true(pl_reflectances[m]->pdf(&s, up, down) == 0.0f);
  }
}

static void test_table(void **state) {
  (void)state;
  for (size_t m = 0; m < pl_reflectance_count; m++) {
    assert_ptr_equal(pl_reflectance_find(pl_reflectances[m]->name), pl_reflectances[m]);
    assert_true(strlen(pl_reflectances[m]->doc) > 0);
  }
  assert_null(pl_reflectance_find("no such model"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_lambert_energy_is_albedo),
      cmocka_unit_test(test_white_furnace),
      cmocka_unit_test(test_same_albedo_as_cycles),
      cmocka_unit_test(test_rough_metal_is_more_saturated),
      cmocka_unit_test(test_smooth_metal_is_a_mirror),
      cmocka_unit_test(test_reciprocity),
      cmocka_unit_test(test_reciprocity_of_boundaries),
      cmocka_unit_test(test_bound_of_the_lobe),
      cmocka_unit_test(test_bound_of_the_density),
      cmocka_unit_test(test_extremes),
      cmocka_unit_test(test_below_the_horizon),
      cmocka_unit_test(test_table),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
