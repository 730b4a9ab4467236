/* Every row of the table of reflectance models: sampling against densities, energy, reciprocity,
 * extreme angles and roughness. */
#include "harness.h"

#include <stdio.h>
#include <string.h>

#include "math/sampler.h"
#include "math/sampling.h"
#include "random.h"
#include "shade/reflectance.h"

enum { DRAWS = 60000, RINGS = 24, SECTORS = 12, FINE = 40 };

static const float alphas[] = {0.0f, 1e-3f, 0.02f, 0.1f, 0.3f, 0.6f, 1.0f};
static const float metals[] = {0.0f, 0.5f, 1.0f};
static const float cosines[] = {1.0f, 0.7f, 0.3f, 0.05f};
#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static pl_surface white(float alpha, float metallic) {
  return (pl_surface){.color = {1.0f, 1.0f, 1.0f}, .alpha = alpha, .metallic = metallic};
}

/* What layered rows are tried with. */
typedef struct variant {
  const char *name;
  float anisotropy, coat, coat_alpha, transmission, ior;
} variant;
static const variant variants[] = {
    {"plain", 0.0f, 0.0f, 1.0f, 0.0f, 1.5f},
    {"ior 1", 0.0f, 0.0f, 1.0f, 0.0f, 1.0f},
    {"ior 2.4", 0.0f, 0.0f, 1.0f, 0.0f, 2.4f},
    {"anisotropic", 0.6f, 0.0f, 1.0f, 0.0f, 1.5f},
    {"most anisotropic", 1.0f, 0.0f, 1.0f, 0.0f, 1.5f},
    {"half a coat", 0.0f, 0.5f, 0.1f, 0.0f, 1.5f},
    {"smooth coat", 0.0f, 1.0f, 0.0f, 0.0f, 1.5f},
    {"roughest coat", 0.0f, 1.0f, 1.0f, 0.0f, 1.5f},
    {"clear", 0.0f, 0.0f, 1.0f, 1.0f, 1.5f},
    {"all", 0.5f, 0.7f, 0.02f, 0.5f, 1.3f},
};
static const char *variant_name = "";

static pl_surface with(pl_surface surface, const variant *v) {
  surface.lobes = (pl_lobes){.anisotropy = v->anisotropy,
                             .coat = v->coat,
                             .coat_alpha = v->coat_alpha,
                             .transmission = v->transmission};
  pl_lobes_set_dielectric(&surface.lobes, v->ior, 1.0f, (pl_vec3f){1.0f, 1.0f, 1.0f});
  variant_name = v->name;
  return surface;
}

/* Disc functions are for dark worlds: what they reflect, with a colour of 1, is judged as with
 * this. */
static const double DARK = 0.12;
static double shade_of(const pl_reflectance *model) { return model->empirical ? DARK : 1.0; }

static pl_vec3f tilted(float cosine, float azimuth) {
  const float sine = sqrtf(fmaxf(0.0f, 1.0f - cosine * cosine));
  return pl_vec3f_make(sine * cosf(azimuth), sine * sinf(azimuth), cosine);
}

/* Calls `check` for every model, roughness, metalness and view, and for layered rows with every
 * variant at every other of these roughnesses. */
typedef void (*check_fn)(const pl_reflectance *model, const pl_surface *surface, pl_vec3f wo);
static void for_all(check_fn check) {
  for (size_t m = 0; m < pl_reflectance_count; m++)
    for (size_t v = 0; v < (pl_reflectances[m]->layered ? COUNT(variants) : 1); v++)
      for (size_t a = 0; a < COUNT(alphas); a += pl_reflectances[m]->layered ? 2 : 1)
        for (size_t k = 0; k < COUNT(metals); k++)
          for (size_t c = 0; c < COUNT(cosines); c++) {
            const pl_surface surface = with(white(alphas[a], metals[k]), &variants[v]);
            check(pl_reflectances[m], &surface, tilted(cosines[c], 0.4f));
          }
}

static bool draw(const pl_reflectance *model, const pl_surface *surface, pl_vec3f wo,
                 test_random *random, pl_vec3f *wi, pl_vec3f *weight, float *pdf) {
  const float u[2] = {(float)(0.99999994 * random_unit(random)),
                      (float)(0.99999994 * random_unit(random))};
  return model->sample(surface, wo, u, (float)(0.99999994 * random_unit(random)), wi, weight, pdf);
}

/* --- chi-square --------------------------------------------------------------------------------
 * Cells are rings and sectors about the mirror direction; 1 - cos of the ring's edge is 2 t^6 for
 * evenly spaced t, so that the narrowest and the widest lobes fill many cells. What passes has
 * cells of its own about the way straight on. */

enum { CELLS = RINGS * SECTORS };

static pl_vec3f turned_over(pl_vec3f w) { return pl_vec3f_make(w.x, w.y, -w.z); }

static double ring_of(double one_minus_cos) { return pow(0.5 * one_minus_cos, 1.0 / 6.0); }

static size_t cell_of(pl_vec3f mirror, pl_vec3f wi) {
  const pl_basis basis = pl_basis_make(mirror);
  const pl_vec3f l = pl_basis_to_local(&basis, wi.z < 0.0f ? turned_over(wi) : wi);
  const double sine2 = (double)l.x * (double)l.x + (double)l.y * (double)l.y;
  const double cosine = l.z > 0.0f ? sqrt(fmax(0.0, 1.0 - sine2)) : -sqrt(fmax(0.0, 1.0 - sine2));
  const double one_minus_cos = cosine > 0.0 ? sine2 / (1.0 + cosine) : 1.0 - cosine;
  const double turn = 0.5 + atan2((double)l.y, (double)l.x) / (2.0 * PL_PI);
  const size_t ring = (size_t)fmin(ring_of(one_minus_cos) * RINGS, RINGS - 1);
  const size_t cell = ring * SECTORS + (size_t)fmin(turn * SECTORS, SECTORS - 1);
  return wi.z < 0.0f ? CELLS + cell : cell;
}

/* Integral of the pdf over a cell by the midpoint rule. */
static double cell_mass(const pl_reflectance *model, const pl_surface *surface, pl_vec3f wo,
                        pl_vec3f mirror, size_t cell) {
  const pl_basis basis = pl_basis_make(mirror);
  const size_t ring = cell % CELLS / SECTORS, sector = cell % SECTORS;
  double sum = 0.0;
  for (int i = 0; i < FINE; i++) {
    const double t = ((double)ring + (i + 0.5) / FINE) / RINGS;
    const double h = 2.0 * pow(t, 6.0), slope = 12.0 * pow(t, 5.0);
    const double sine = sqrt(h * (2.0 - h));
    for (int k = 0; k < FINE; k++) {
      const double a = 2.0 * PL_PI * (((double)sector + (k + 0.5) / FINE) / SECTORS - 0.5);
      const pl_vec3f local = {(float)(sine * cos(a)), (float)(sine * sin(a)), (float)(1.0 - h)};
      const pl_vec3f wi = pl_basis_to_world(&basis, local);
      if (wi.z > 0.0f)
        sum += slope * (double)model->pdf(surface, wo, cell < CELLS ? wi : turned_over(wi));
    }
  }
  return sum * 2.0 * PL_PI / SECTORS / RINGS / (FINE * FINE);
}

/* Standard normal quantile of chi-square (Wilson and Hilferty 1931). */
static double chi_square_sigma(double chi2, double freedom) {
  const double v = 2.0 / (9.0 * freedom);
  return (cbrt(chi2 / freedom) - (1.0 - v)) / sqrt(v);
}

static double worst_sigma, largest_mass;

static void check_chi_square(const pl_reflectance *model, const pl_surface *surface, pl_vec3f wo) {
  static int count[2 * CELLS];
  test_random random = {.seed = 21};
  const pl_vec3f mirror = pl_vec3f_make(-wo.x, -wo.y, wo.z);
  int lost = 0;
  if (surface->lobes.anisotropy > 0.0f && !(surface->alpha > 0.0f))
    return; /* a stripe too narrow for the midpoint rule */
  memset(count, 0, sizeof count);
  for (int i = 0; i < DRAWS; i++) {
    pl_vec3f wi, weight;
    float pdf;
    if (draw(model, surface, wo, &random, &wi, &weight, &pdf))
      count[cell_of(mirror, wi)]++;
    else
      lost++;
  }
  double chi2 = 0.0, mass = 0.0, pooled = 0.0, pooled_count = 0.0;
  int freedom = 0;
  for (size_t i = 0; i < (surface->lobes.transmission > 0.0f ? 2 * CELLS : CELLS); i++) {
    const double cell = cell_mass(model, surface, wo, mirror, i), expected = cell * DRAWS;
    mass += cell;
    if (expected < 10.0) {
      pooled += expected;
      pooled_count += count[i];
      continue;
    }
    chi2 += (count[i] - expected) * (count[i] - expected) / expected;
    freedom++;
  }
  /* What is drawn below the horizon joins the small cells. */
  pooled += fmax(0.0, 1.0 - mass) * DRAWS;
  pooled_count += lost;
  chi2 += (pooled_count - pooled) * (pooled_count - pooled) / fmax(pooled, 10.0);
  const double sigma = chi_square_sigma(chi2, freedom);
  if (sigma > 5.0 || mass > 1.003)
    fail_msg("%s %s alpha %g metallic %g cos %g: chi-square %.1f for %d (%.1f sigma), mass %.5f",
             model->name, variant_name, (double)surface->alpha, (double)surface->metallic,
             (double)wo.z, chi2, freedom, sigma, mass);
  worst_sigma = fmax(worst_sigma, sigma);
  largest_mass = fmax(largest_mass, mass);
}

/* 648 tests at 5 sigma: a false alarm once in 5e3 seeds; the seed is fixed. */
static void test_sampling_follows_pdf(void **state) {
  (void)state;
  for_all(check_chi_square);
  print_message("seed 21: worst %.2f sigma, largest integral of a pdf %.5f\n", worst_sigma,
                largest_mass);
}

/* --- weights and energy ----------------------------------------------------------------------- */

static void check_weight(const pl_reflectance *model, const pl_surface *surface, pl_vec3f wo) {
  test_random random = {.seed = 22};
  for (int i = 0; i < 2000; i++) {
    pl_vec3f wi, weight;
    float pdf;
    if (!draw(model, surface, wo, &random, &wi, &weight, &pdf))
      continue;
    assert_true(fabsf(pl_vec3f_norm(wi) - 1.0f) < 1e-4f);
    assert_true(pdf > 0.0f && isfinite(pdf));
    const float again = model->pdf(surface, wo, wi);
    assert_true(fabsf(again - pdf) <= 1e-5f * pdf);
    const pl_vec3f value = model->evaluate(surface, wo, wi);
    assert_true(fabsf(value.x - weight.x * pdf) <= 1e-5f * value.x + 1e-30f);
  }
}

static void test_weight_is_value_over_pdf(void **state) {
  (void)state;
  for_all(check_weight);
}

static double largest_energy;

/* Light sent on under a white sky of radiance 1, by the mean weight. */
static void check_energy(const pl_reflectance *model, const pl_surface *surface, pl_vec3f wo) {
  test_random random = {.seed = 23};
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < DRAWS; i++) {
    pl_vec3f wi, weight;
    float pdf;
    if (!draw(model, surface, wo, &random, &wi, &weight, &pdf))
      continue;
    const double part = shade_of(model) * (double)weight.x;
    sum += part;
    squares += part * part;
  }
  const double mean = sum / DRAWS, sigma = sqrt((squares / DRAWS - mean * mean) / DRAWS);
  if (mean > 1.0 + 5.0 * sigma + 1e-5)
    fail_msg("%s %s alpha %g metallic %g cos %g reflects %.4f +- %.4f of the light", model->name,
             variant_name, (double)surface->alpha, (double)surface->metallic, (double)wo.z, mean,
             sigma);
  largest_energy = fmax(largest_energy, mean);
}

/* 5 sigma, 648 tests: a false alarm once in 5e3 seeds. */
static void test_energy(void **state) {
  (void)state;
  for_all(check_energy);
  print_message("seed 23: largest reflected fraction %.5f\n", largest_energy);
}

static void test_lambert_energy_is_albedo(void **state) {
  (void)state;
  pl_surface surface = white(1.0f, 0.0f);
  surface.color = pl_vec3f_make(0.1f, 0.5f, 1.0f);
  const pl_vec3f up = pl_vec3f_make(0.0f, 0.0f, 1.0f);
  const pl_vec3f value = pl_reflectance_lambert.evaluate(&surface, up, up);
  assert_true(fabsf(value.x * PL_PI_F - 0.1f) < 1e-6f && fabsf(value.z * PL_PI_F - 1.0f) < 1e-6f);
}

/* --- the white furnace ------------------------------------------------------------------------ */

enum { FURNACE_DRAWS = 1 << 14 };

/* Light reflected under a white sky, by stratified draws: in [0] the draws of `sample`, in [1] the
 * integral of `evaluate` over the hemisphere, to which sampling contributes nothing. */
static void furnace(const pl_reflectance *model, const pl_surface *surface, pl_vec3f wo,
                    double out[2]) {
  out[0] = out[1] = 0.0;
  for (uint32_t i = 0; i < FURNACE_DRAWS; i++) {
    float u[2], choice[2], pdf;
    pl_vec3f wi, weight;
    pl_sample_2d(i, 26, 0, u);
    pl_sample_2d(i, 26, 1, choice);
    if (model->sample(surface, wo, u, choice[0], &wi, &weight, &pdf))
      out[0] += (double)weight.x / FURNACE_DRAWS;
    wi = pl_sample_cosine_hemisphere(u[0], u[1]);
    if (wi.z > 0.0f)
      out[1] += (double)(model->evaluate(surface, wo, wi).x / pl_cosine_hemisphere_pdf(wi.z)) /
                FURNACE_DRAWS;
  }
}

/* A white surface returns all light: within 0.005 for views up to 85 deg from the normal. The
 * integral without sampling is looked at where lobes are broad. */
static void test_white_furnace(void **state) {
  (void)state;
  double worst = 0.0, worst_flat = 0.0;
  for (int r = 1; r <= 20; r++)
    for (int degrees = 0; degrees <= 85; degrees += 5) {
      const float roughness = 0.05f * (float)r;
      const pl_surface metal = white(roughness * roughness, 1.0f);
      const pl_vec3f wo = tilted(cosf((float)degrees * PL_PI_F / 180.0f), 0.4f);
      double energy[2];
      furnace(&pl_reflectance_metallic_roughness, &metal, wo, energy);
      if (fabs(energy[0] - 1.0) > 0.005)
        fail_msg("roughness %g at %d deg reflects %.4f", (double)roughness, degrees, energy[0]);
      worst = fmax(worst, fabs(energy[0] - 1.0));
      if (roughness > 0.65f)
        worst_flat = fmax(worst_flat, fabs(energy[1] - 1.0));
      furnace(&pl_reflectance_lambert, &metal, wo, energy);
      assert_true(fabs(energy[0] - 1.0) < 1e-5 && fabs(energy[1] - 1.0) < 1e-5);
    }
  print_message("white GGX furnace: off by at most %.4f sampled, %.4f integrated\n", worst,
                worst_flat);
  assert_true(worst_flat < 0.005);
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
  largest_energy = 0.0;
  const pl_surface surface = white(1e-3f, 1.0f);
  check_energy(&pl_reflectance_metallic_roughness, &surface, tilted(0.7f, 0.0f));
  assert_true(fabs(largest_energy - 1.0) < 1e-3);
}

/* --- reciprocity, bounds, extremes ------------------------------------------------------------ */

static void test_reciprocity(void **state) {
  (void)state;
  test_random random = {.seed = 24};
  for (size_t m = 0; m < pl_reflectance_count; m++) {
    for (int i = 0; i < 100000; i++) {
      const pl_surface s = with(
          white(alphas[1 + random_below(&random, COUNT(alphas) - 1)], (float)random_unit(&random)),
          &variants[random_below(&random, COUNT(variants))]);
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

/* What the plan's bounds rest on: pi f cos <= max(1, 1/(2 alpha^3)), but for what rough metals
 * reflect several times: at alpha = 1 and normal incidence 0.25 by one reflection and 0.8 more. */
static void test_bound_of_the_lobe(void **state) {
  (void)state;
  test_random random = {.seed = 25};
  double nearest = 0.0;
  for (size_t m = 0; m < pl_reflectance_count; m++) {
    for (int i = 0; i < 300000; i++) {
      const double alpha = random_scale(&random, 0.03, 1.0);
      const pl_surface s = with(white((float)alpha, (float)random_unit(&random)),
                                &variants[random_below(&random, 5)]);
      const pl_vec3f wo = tilted((float)random_scale(&random, 1e-3, 1), 0.0f);
      const pl_vec3f wi = tilted((float)random_scale(&random, 1e-3, 1),
                                 (float)(PL_PI + alpha * random_range(&random, -3, 3)));
      const double value =
          PL_PI * shade_of(pl_reflectances[m]) * (double)pl_reflectances[m]->evaluate(&s, wo, wi).x;
      const double bound = fmax(1.06, 0.5 / (alpha * alpha * alpha)); /* gain() of plan/view.c */
      if (value > bound * (1.0 + 1e-5))
        fail_msg("%s %s alpha %g metallic %g: %g over %g", pl_reflectances[m]->name, variant_name,
                 alpha, (double)s.metallic, value, bound);
      nearest = fmax(nearest, value / bound);
    }
  }
  print_message("seed 25: the bound is used up to %.3f\n", nearest);
  assert_true(nearest > 0.5);
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
  for (int i = 0; i < 64; i++) {
    const float u[2] = {corner[i & 3], corner[i >> 2 & 3]};
    pl_vec3f wi, weight;
    float pdf;
    if (!model->sample(s, wo, u, corner[i >> 4], &wi, &weight, &pdf))
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
            pl_surface s = with(white(alphas[a], metals[k]), &variants[v]);
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
      cmocka_unit_test(test_sampling_follows_pdf),
      cmocka_unit_test(test_weight_is_value_over_pdf),
      cmocka_unit_test(test_energy),
      cmocka_unit_test(test_lambert_energy_is_albedo),
      cmocka_unit_test(test_white_furnace),
      cmocka_unit_test(test_rough_metal_is_more_saturated),
      cmocka_unit_test(test_smooth_metal_is_a_mirror),
      cmocka_unit_test(test_reciprocity),
      cmocka_unit_test(test_bound_of_the_lobe),
      cmocka_unit_test(test_extremes),
      cmocka_unit_test(test_below_the_horizon),
      cmocka_unit_test(test_table),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
