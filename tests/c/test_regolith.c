/* Photometric rows of the reflectance table: their laws in float, draws with their parameters, and
 * their nodes. */
#include "harness.h"

#include <stdio.h>

#include "math/sampler.h"
#include "math/sampling.h"
#include "random.h"
#include "shade/hapke.h"
#include "shade/reflectance.h"

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

/* The Moon's mare (Sato et al. 2014, the cell of Tranquility base at 566 nm), its median at 643 nm,
 * and a made-up soil with all terms; see test_hapke.c. A(i) at 0, 30, 60 and 80 degrees: Gauss
 * quadrature of the mpmath model, to the digits printed. */
typedef struct soil {
  float w;
  pl_regolith_band band;
  double kept[4];
} soil;
static const soil soils[] = {
    {0.188f,
     {0.254f, 0.158f, 0.0f, 0.0f, 2.134f, 0.0623f, 0.41289253f, 0.0f},
     {0.04557354, 0.04741366, 0.04952283, 0.05113838}},
    {0.3854f,
     {0.2375f, 0.3253f, 0.0f, 0.0f, 1.686f, 0.0672f, 0.41289253f, 0.0f},
     {0.10482711, 0.10900923, 0.11332527, 0.11670863}},
    {0.6f,
     {0.3f, 0.4f, 0.5f, 0.01f, 1.0f, 0.05f, 0.52359878f, 0.4f},
     {0.27041613, 0.27672797, 0.26566323, 0.26516000}},
};

static pl_surface surface_of(const soil *s) {
  return (pl_surface){.color = {s->w, s->w, s->w},
                      .alpha = 1.0f,
                      .regolith = {.band = {s->band, s->band, s->band}}};
}

static pl_hapke hapke_of(const soil *s) {
  const pl_regolith_band *b = &s->band;
  return (pl_hapke){(double)s->w,       (double)b->b,    (double)b->c,   (double)b->b_s0,
                    (double)b->h_s,     (double)b->b_c0, (double)b->h_c, (double)b->roughness_rad,
                    (double)b->filling, false,           false};
}

static pl_vec3f tilted(float cosine, float azimuth) {
  const float sine = sqrtf(fmaxf(0.0f, 1.0f - cosine * cosine));
  return pl_vec3f_make(sine * cosf(azimuth), sine * sinf(azimuth), cosine);
}

/* What the renderer gets, against the model in double, for sun and view up to 89 degrees: 1e-5,
 * where the phase angle is what floats can say (0.03 degrees and more, the sun's disc is 0.5). */
static void test_rows_in_float(void **state) {
  (void)state;
  test_random random = {.seed = 71};
  double worst = 0.0;
  for (int k = 0; k < 200000; k++) {
    const soil *s = &soils[k % 3];
    const pl_surface surface = surface_of(s);
    const double i = random_range(&random, 0.0, 1.553), e = random_range(&random, 0.0, 1.553);
    const double psi = random_range(&random, -PL_PI, PL_PI);
    const pl_vec3 sun = {sin(i), 0.0, cos(i)}, eye = {sin(e) * cos(psi), sin(e) * sin(psi), cos(e)};
    if (pl_hapke_angles_of(sun, eye).half_tangent < 2.6e-4)
      continue;
    pl_hapke hapke = hapke_of(s);
    const double rough = pl_hapke_reflectance(&hapke, sun, eye);
    const pl_vec3f wi = pl_vec3_to_float(sun), wo = pl_vec3_to_float(eye);
    const double got = (double)pl_reflectance_hapke.evaluate(&surface, wo, wi).y;
    worst = fmax(worst, fabs(got / rough - 1.0));
    hapke.roughness_rad = 0.0;
    const double smooth = pl_hapke_reflectance(&hapke, sun, eye);
    const double plane = (double)pl_reflectance_hapke_smooth.evaluate(&surface, wo, wi).x;
    worst = fmax(worst, fabs(plane / smooth - 1.0));
  }
  print_message("seed 71: rows off by at most %.1e\n", worst);
  assert_true(worst < 1e-5);
}

/* Each band has its own parameters. */
static void test_bands(void **state) {
  (void)state;
  pl_surface mixed = surface_of(&soils[0]);
  mixed.color.y = soils[1].w;
  mixed.regolith.band[1] = soils[1].band;
  mixed.color.z = soils[2].w;
  mixed.regolith.band[2] = soils[2].band;
  const pl_vec3f wo = tilted(0.8f, 0.0f), wi = tilted(0.4f, 2.0f);
  for (size_t m = 0; m < pl_reflectance_count; m++) {
    if (!pl_reflectances[m]->photometric)
      continue;
    const pl_vec3f value = pl_reflectances[m]->evaluate(&mixed, wo, wi);
    const float got[3] = {value.x, value.y, value.z};
    for (size_t k = 0; k < 3; k++) {
      const pl_surface grey = surface_of(&soils[k]);
      assert_true(got[k] == pl_reflectances[m]->evaluate(&grey, wo, wi).x);
    }
  }
}

/* The laws' formulae at i = 60, e = 30, in the plane of the sun on the other side: g = 90, where
 * the Moon's L is 1 - 0.019 90 + 2.42e-4 90^2 - 1.46e-6 90^3 = 0.18586. */
static void test_cheap_laws(void **state) {
  (void)state;
  const double mu0 = 0.5, mu = 0.8660254037844386;
  pl_surface grey = {.color = {0.2f, 0.2f, 0.2f}, .regolith = {.limb = -0.4f}};
  const pl_vec3f wi = pl_vec3f_make((float)mu, 0.0f, (float)mu0);
  const pl_vec3f wo = pl_vec3f_make(-(float)mu0, 0.0f, (float)mu);
  const double seeliger = 0.2 / (4.0 * PL_PI) * mu0 / (mu0 + mu);
  const double lunar = 0.2 / PL_PI * (0.18586 * 2.0 * mu0 / (mu0 + mu) + 0.81414 * mu0);
  const double minnaert = 0.2 / PL_PI * pow(mu0, 0.6) * pow(mu, -0.4);
  const struct {
    const pl_reflectance *model;
    double value;
  } rows[] = {{&pl_reflectance_lommel_seeliger, seeliger},
              {&pl_reflectance_lunar_lambert, lunar},
              {&pl_reflectance_minnaert, minnaert}};
  for (size_t k = 0; k < COUNT(rows); k++)
    assert_true(fabs((double)rows[k].model->evaluate(&grey, wo, wi).x / rows[k].value - 1.0) <
                1e-6);
  /* With a phase function a normal albedo stays the albedo at g = 0, and falls away from it. */
  for (int k = 0; k < 3; k++)
    grey.regolith.band[k] = soils[1].band;
  const pl_vec3f up = pl_vec3f_make(0.0f, 0.0f, 1.0f);
  for (size_t k = 1; k < COUNT(rows); k++) {
    const double normal = PL_PI * (double)rows[k].model->evaluate(&grey, up, up).x;
    assert_true(fabs(normal - 0.2) < 1e-6);
    assert_true((double)rows[k].model->evaluate(&grey, wo, wi).x < 0.4 * rows[k].value);
  }
}

/* Draws find the light that the surface keeps (A(i), by reciprocity for light from all around),
 * with little noise. */
static void test_sampling(void **state) {
  (void)state;
  enum { DRAWS = 1 << 14 };
  static const double degrees[] = {0.0, 30.0, 60.0, 80.0};
  double noisiest = 0.0, worst = 0.0;
  for (size_t s = 0; s < COUNT(soils); s++)
    for (size_t k = 0; k < COUNT(degrees); k++) {
      const pl_surface surface = surface_of(&soils[s]);
      const pl_vec3f wo = tilted(cosf((float)(degrees[k] * PL_PI / 180.0)), 0.4f);
      double sum = 0.0, squares = 0.0;
      for (uint32_t i = 0; i < DRAWS; i++) {
        float u[2], pdf;
        pl_vec3f wi, weight;
        pl_sample_2d(i, 72, 0, u);
        if (!pl_reflectance_hapke.sample(&surface, wo, u, &wi, &weight, &pdf))
          continue;
        sum += (double)weight.x;
        squares += (double)weight.x * (double)weight.x;
      }
      const double mean = sum / DRAWS, variance = squares / DRAWS - mean * mean;
      worst = fmax(worst, fabs(mean / soils[s].kept[k] - 1.0));
      noisiest = fmax(noisiest, sqrt(variance) / mean);
    }
  print_message("seed 72: means off by at most %.4f, scatter of a draw up to %.2f\n", worst,
                noisiest);
  assert_true(worst < 0.01);
  assert_true(noisiest < 0.8);
}

/* Reciprocal with all parameters; finite at all ends of the ranges that configurations have. */
static void test_reciprocity_and_extremes(void **state) {
  (void)state;
  test_random random = {.seed = 73};
  static const float ends[][2] = {{0.0f, 0.95f}, {-1.0f, 1.2f}, {0.0f, 1.0f},        {0.0f, 1.0f},
                                  {0.0f, 2.5f},  {0.0f, 1.0f},  {0.0f, 1.04719755f}, {0.0f, 0.75f}};
  static const float grazing[] = {1.0f, 0.5f, 1e-3f, 1e-7f, 1e-20f, 1e-40f};
  for (int k = 0; k < 20000; k++) {
    pl_surface s = {.color = {(float)random_unit(&random), 0.0f, 1.0f},
                    .regolith = {.limb = (float)random_range(&random, -1.0, 1.0)}};
    for (size_t j = 0; j < PL_REGOLITH_VALUES; j++)
      for (int band = 0; band < 3; band++)
        ((float *)&s.regolith.band[band])[j] =
            k % 2 == 0 ? ends[j][random_below(&random, 2)]
                       : (float)random_range(&random, (double)ends[j][0], (double)ends[j][1]);
    const pl_vec3f a = tilted(k % 3 == 0 ? grazing[random_below(&random, COUNT(grazing))]
                                         : (float)random_range(&random, 0.01, 1.0),
                              0.0f);
    const pl_vec3f b = tilted(k % 3 == 0 ? grazing[random_below(&random, COUNT(grazing))]
                                         : (float)random_range(&random, 0.01, 1.0),
                              k % 5 == 0 ? PL_PI_F : (float)random_range(&random, -PL_PI, PL_PI));
    for (size_t m = 0; m < pl_reflectance_count; m++) {
      const pl_reflectance *model = pl_reflectances[m];
      if (!model->photometric)
        continue;
      const pl_vec3f there = model->evaluate(&s, a, b), back = model->evaluate(&s, b, a);
      assert_true(isfinite(there.x) && isfinite(there.y) && isfinite(there.z));
      assert_true(there.x >= 0.0f && there.z >= 0.0f);
      if (model != &pl_reflectance_lunar_lambert && model != &pl_reflectance_minnaert)
        assert_true(there.y == 0.0f);
      if (k % 3 != 0)
        assert_true(fabsf(there.x / b.z - back.x / a.z) <= 1e-5f * (there.x / b.z) + 1e-30f);
      assert_true(isfinite(model->pdf(&s, a, b)));
    }
  }
}

/* No angles make a soil brighter than its peak, which is near. */
static void test_peak(void **state) {
  (void)state;
  test_random random = {.seed = 74};
  for (size_t m = 0; m < pl_reflectance_count; m++)
    for (size_t s = 0; pl_reflectances[m]->photometric && s < COUNT(soils); s++) {
      pl_surface surface = surface_of(&soils[s]);
      surface.reflectance = pl_reflectances[m];
      surface.regolith.limb = -0.4f;
      const double peak = pl_regolith_peak(&surface);
      double most = 0.0;
      for (int k = 0; k < 20000; k++) {
        const pl_vec3f wo = tilted((float)random_unit(&random), 0.0f);
        const pl_vec3f wi =
            k % 2 == 0 ? wo
                       : tilted((float)random_unit(&random), (float)random_range(&random, 0, 7));
        most = fmax(most, PL_PI * (double)surface.reflectance->evaluate(&surface, wo, wi).x);
      }
      if (!(most <= peak && most > 0.4 * peak))
        fail_msg("%s, soil %zu: %g, peak %g", surface.reflectance->name, s, most, peak);
    }
}

/* As nodes: what is given is set and cut off at its range, the rest is the Moon's. */
static void test_inputs(void **state) {
  (void)state;
  const pl_reflectance *model = &pl_reflectance_hapke;
  const float b[3] = {0.1f, 5.0f, NAN}, angle[3] = {90.0f, 90.0f, 90.0f};
  pl_surface_inputs in = {.set = 1u << 0 | 1u << 7};
  in.value[0] = b;
  in.value[7] = angle;
  pl_surface s = {.reflectance = model};
  assert_int_equal(model->input_count, 8);
  assert_string_equal(model->inputs[7].name, "roughness_deg");
  model->set(&in, &s);
  assert_true(s.regolith.band[0].b == 0.1f && s.regolith.band[1].b == 0.95f);
  assert_true(s.regolith.band[2].b == 0.0f && s.regolith.band[2].c == 0.3253f);
  assert_true(fabsf(s.regolith.band[1].roughness_rad - PL_PI_F / 3.0f) < 1e-6f);
  pl_reflectance_minnaert.set(&(pl_surface_inputs){0}, &s);
  assert_true(fabsf(s.regolith.limb + 0.45f) < 1e-6f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_rows_in_float),
      cmocka_unit_test(test_bands),
      cmocka_unit_test(test_cheap_laws),
      cmocka_unit_test(test_sampling),
      cmocka_unit_test(test_reciprocity_and_extremes),
      cmocka_unit_test(test_peak),
      cmocka_unit_test(test_inputs),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
