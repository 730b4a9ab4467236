/* The row `principled` where its value is known: against the metallic-roughness row, as Lambert, as
 * a mirror turned over, and under a white sky. Sampling, energy and reciprocity: test_reflectance.
 */
#include "harness.h"

#include "math/sampler.h"
#include "math/sampling.h"
#include "random.h"
#include "shade/reflectance.h"

enum { DRAWS = PL_DRAWS(1 << 14, 1 << 12) };
static const double SCATTER = PL_DRAWS(0.0, 0.005); /* more than that of all draws */

static const pl_reflectance *const row = &pl_reflectance_principled;

static pl_vec3f tilted(float cosine, float azimuth) {
  const float sine = sqrtf(fmaxf(0.0f, 1.0f - cosine * cosine));
  return pl_vec3f_make(sine * cosf(azimuth), sine * sinf(azimuth), cosine);
}

static pl_surface plain(float alpha, float metallic) {
  return (pl_surface){
      .color = {1.0f, 1.0f, 1.0f}, .alpha = alpha, .metallic = metallic, .lobes = pl_lobes_plain()};
}

/* Light sent on above and below under a white sky, by stratified draws. */
static void furnace(const pl_surface *s, pl_vec3f wo, double out[2]) {
  out[0] = out[1] = 0.0;
  for (uint32_t i = 0; i < DRAWS; i++) {
    float u[2], pdf;
    pl_vec3f wi, weight;
    pl_sample_2d(i, 31, 0, u);
    if (row->sample(s, wo, u, &wi, &weight, &pdf))
      out[wi.z < 0.0f] += (double)weight.x / DRAWS;
  }
}

static bool near(float a, float b, float relative) {
  return fabsf(a - b) <= relative * fmaxf(fabsf(a), fabsf(b)) + 1e-12f;
}

/* With plain lobes it is the metallic-roughness surface, but for what their tables are off. */
static void test_plain_is_metallic_roughness(void **state) {
  (void)state;
  test_random random = {.seed = 41};
  for (int i = 0; i < PL_DRAWS(100000, 10000); i++) {
    pl_surface s = plain((float)random_scale(&random, 1e-3, 1.0), (float)random_unit(&random));
    s.color = pl_vec3f_make((float)random_unit(&random), 0.5f, 0.0f);
    const pl_vec3f wo = tilted((float)random_range(&random, 0.01, 1), 0.3f);
    const pl_vec3f wi =
        tilted((float)random_range(&random, 0.01, 1), (float)random_range(&random, -3, 3));
    const pl_vec3f a = row->evaluate(&s, wo, wi);
    const pl_vec3f b = pl_reflectance_metallic_roughness.evaluate(&s, wo, wi);
    const float off = pl_vec3f_norm(pl_vec3f_sub(a, b));
    assert_true(off <= 1e-3f * pl_vec3f_norm(b) + 1e-3f);
  }
}

/* Index 1 leaves no surface to mirror anything: Lambert, however smooth, to the horizon. */
static void test_ior_1_is_lambert(void **state) {
  (void)state;
  const float cosines[] = {1.0f, 0.5f, 1e-3f};
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) {
      pl_surface s = plain(0.01f, 0.0f);
      pl_lobes_set_dielectric(&s.lobes, 1.0f, 1.0f, pl_vec3f_make(1.0f, 1.0f, 1.0f));
      const pl_vec3f wo = tilted(cosines[i], 0.0f), wi = tilted(cosines[k], PL_PI_F);
      assert_true(near(row->evaluate(&s, wo, wi).x, wi.z / PL_PI_F, 1e-6f));
    }
}

/* Fresnel's formula at normal incidence: 0.04, 0.02 and 0.17 for indices 1.5, 1.33 and 2.4. */
static void test_index(void **state) {
  (void)state;
  const float index[] = {1.5f, 1.33f, 2.4f, 1.0f, 0.0f};
  const float f0[] = {0.04f, 0.0200593f, 0.1695502f, 0.0f, 1.0f};
  const float f90[] = {1.0f, 1.0f, 1.0f, 0.0f, 1.0f};
  for (int i = 0; i < 5; i++) {
    pl_lobes lobes = pl_lobes_plain();
    pl_lobes_set_dielectric(&lobes, index[i], 1.0f, pl_vec3f_make(1.0f, 1.0f, 1.0f));
    assert_true(fabsf(lobes.f0.x - f0[i]) < 1e-6f && fabsf(lobes.f90 - f90[i]) < 1e-6f);
  }
  pl_lobes lobes = pl_lobes_plain();
  pl_lobes_set_dielectric(&lobes, 1.5f, 0.5f, pl_vec3f_make(1.0f, 0.5f, 0.0f));
  assert_true(near(lobes.f0.x, 0.02f, 1e-5f) && near(lobes.f0.y, 0.01f, 1e-5f));
  assert_true(lobes.f0.z == 0.0f && lobes.f90 == 0.5f);
}

/* Fresnel's formula in the form of sines and tangents, for glass of 1.5 from outside or inside. */
static double fresnel(double angle, bool inside) {
  const double sine = sin(angle) * (inside ? 1.5 : 1.0 / 1.5), t = asin(fmin(sine, 1.0));
  if (angle < 1e-6)
    return 0.04;
  const double across = sin(angle - t) / sin(angle + t), along = tan(angle - t) / tan(angle + t);
  return sine < 1.0 ? 0.5 * (across * across + along * along) : 1.0;
}

/* A smooth clear wall: Fresnel's part is mirrored, the rest goes straight on. */
static void test_smooth_wall(void **state) {
  (void)state;
  for (int degrees = 0; degrees <= 80; degrees += 10) {
    pl_surface s = plain(0.0f, 0.0f);
    s.lobes.transmission = 1.0f;
    const float cosine = cosf((float)degrees * PL_PI_F / 180.0f);
    const double mirrored = fresnel(degrees * PL_PI / 180.0, false);
    double energy[2];
    furnace(&s, tilted(cosine, 0.4f), energy);
    assert_true(fabs(energy[0] - mirrored) < 2e-3 && fabs(energy[1] - 1.0 + mirrored) < 2e-3);
    pl_vec3f wi, weight;
    float pdf;
    const float u[2] = {0.99f, 0.6f};
    assert_true(row->sample(&s, tilted(cosine, 0.4f), u, &wi, &weight, &pdf));
    const pl_vec3f on = pl_vec3f_scale(tilted(cosine, 0.4f), -1.0f);
    assert_true(wi.z < 0.0f && pl_vec3f_norm(pl_vec3f_sub(wi, on)) < 0.03f);
  }
}

/* Largest and least excess of light that white sends on, for views up to 85 deg. */
typedef struct layers {
  float anisotropy, metallic, transmission, coat, index;
} layers;
static void extremes_of(const layers *l, double out[2]) {
  const float to_rad = PL_PI_F / 180.0f;
  out[0] = -1.0;
  out[1] = 1.0;
  for (int r = 2; r <= 10; r += 2)
    for (int degrees = 0; degrees <= 85; degrees += 17)
      for (int turn = 0; turn <= (l->anisotropy > 0.0f ? 90 : 0); turn += 45) {
        const float roughness = 0.1f * (float)r;
        pl_surface s = plain(roughness * roughness, l->metallic);
        pl_lobes_set_dielectric(&s.lobes, l->index, 1.0f, pl_vec3f_make(1.0f, 1.0f, 1.0f));
        s.lobes.anisotropy = l->anisotropy;
        s.lobes.transmission = l->transmission;
        s.lobes.coat = l->coat;
        s.lobes.coat_alpha = 0.09f;
        double energy[2];
        furnace(&s, tilted(cosf((float)degrees * to_rad), (float)turn * to_rad), energy);
        out[0] = fmax(out[0], energy[0] + energy[1] - 1.0);
        out[1] = fmin(out[1], energy[0] + energy[1] - 1.0);
      }
}

/* White metals and walls send on all light but 1 %, whatever their anisotropy. */
static void test_white_furnace(void **state) {
  (void)state;
  const float strength[] = {0.0f, 0.05f, 0.3f, 0.6f, 0.8f, 1.0f};
  for (int i = 0; i < 6; i += PL_DRAWS(1, 4))
    for (int wall = 0; wall < 2; wall++) {
      double off[2];
      const layers l = {strength[i], wall ? 0.0f : 1.0f, wall ? 1.0f : 0.0f, 0.0f, 1.5f};
      extremes_of(&l, off);
      print_message("anisotropy %g, %s: %.4f to %.4f\n", (double)strength[i],
                    wall ? "wall" : "metal", off[1], off[0]);
      assert_true(off[0] < 0.01 + SCATTER && off[1] > -0.01 - SCATTER);
    }
}

/* Nor do white dielectrics lose light, whatever their index, nor half a metal, nor walls that pass
 * half of it: what the boundary does not reflect comes back from the base. Below coats up to 0.01
 * is lost of light from a Lambert base, 0.06 of what metals mirror broadly; at an anisotropy of
 * 0.6, see principled.c. */
static void test_white_furnace_of_dielectrics(void **state) {
  (void)state;
  static const struct {
    layers layers;
    double lost;
  } cases[] = {
      {{.index = 1.5f}, 0.006},
      {{.index = 1.02f}, 0.006},
      {{.index = 1.33f}, 0.006},
      {{.index = 2.5f}, 0.006},
      {{.index = 20.0f}, 0.006},
      {{.index = 0.7f}, 0.006},
      {{.metallic = 0.5f, .index = 1.5f}, 0.006},
      {{.transmission = 0.5f, .index = 1.5f}, 0.006},
      {{.anisotropy = 0.6f, .index = 1.5f}, 0.045},
      {{.coat = 1.0f, .index = 1.5f}, 0.01},
      {{.coat = 0.5f, .index = 2.0f}, 0.01},
      {{.coat = 1.0f, .metallic = 1.0f, .index = 1.5f}, 0.06},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    const layers *l = &cases[i].layers;
    double off[2];
    extremes_of(l, off);
    print_message("index %g, metallic %g, transmission %g, coat %g, anisotropy %g: %.4f to %.4f\n",
                  (double)l->index, (double)l->metallic, (double)l->transmission, (double)l->coat,
                  (double)l->anisotropy, off[1], off[0]);
    assert_true(off[0] < 0.01 + SCATTER && off[1] > -cases[i].lost - SCATTER);
  }
}

/* Smith's Lambda of the lobe below, for what Mitsuba's product of two maskings lacks of ours. */
static double lambda(pl_vec3f w) {
  const double x = 0.2 * (double)w.x, y = 0.05 * (double)w.y, z = (double)w.z;
  return 0.5 * (sqrt(1.0 + (x * x + y * y) / (z * z)) - 1.0);
}

/* Mitsuba 3.9.1, `principled` with base_color (0.9, 0.5, 0.2), metallic 1, roughness sqrt(0.1),
 * anisotropic 0.75/0.9: alpha 0.2 along the tangent, 0.05 across; value times cosine, red and blue.
 * Ours adds light reflected several times, here up to 2 % of the lobe. */
static void test_same_as_mitsuba(void **state) {
  (void)state;
  static const float at[][6] = {
      {1.0f, 0.0f, 1.0f, 0.0f, 7.16197205f, 1.59154933f},
      {0.95f, 0.0f, 0.95f, 3.14159265f, 7.52267504f, 1.67170775f},
      {0.95f, 0.0f, 0.9f, 3.0f, 3.17613053f, 0.70581239f},
      {0.9f, 1.57079633f, 0.95f, -1.4f, 0.93022662f, 0.20671864f},
      {0.85f, 0.785398f, 0.8f, 4.0f, 2.14691186f, 0.47738683f},
      {0.98f, 0.0f, 0.9f, 0.3f, 0.29183096f, 0.06485133f},
      {0.98f, 2.0f, 0.97f, 1.0f, 0.02849000f, 0.00633111f},
  };
  pl_surface s = plain(0.05f, 1.0f);
  s.color = pl_vec3f_make(0.9f, 0.5f, 0.2f);
  s.lobes.anisotropy = sqrtf(0.15f / 0.95f);
  for (size_t i = 0; i < sizeof at / sizeof at[0]; i++) {
    const pl_vec3f wo = tilted(at[i][0], at[i][1]), wi = tilted(at[i][2], at[i][3]);
    const double o = lambda(wo), l = lambda(wi), masked = (1.0 + o + l) / ((1.0 + o) * (1.0 + l));
    const pl_vec3f value = row->evaluate(&s, wo, wi);
    const double red = (double)value.x * masked, blue = (double)value.z * masked;
    if (fabs(red - (double)at[i][4]) > 0.02 * red + 0.006 ||
        fabs(blue - (double)at[i][5]) > 0.02 * blue + 0.006)
      fail_msg("directions %zu: %g and %g, not %g and %g", i, red, blue, (double)at[i][4],
               (double)at[i][5]);
  }
}

/* Anisotropy widens the lobe along x alone. */
static void test_anisotropy_has_a_direction(void **state) {
  (void)state;
  pl_surface s = plain(0.05f, 1.0f);
  s.lobes.anisotropy = 0.7f;
  const pl_vec3f up = tilted(1.0f, 0.0f);
  const float along = row->evaluate(&s, up, tilted(0.9f, 0.0f)).x;
  const float across = row->evaluate(&s, up, tilted(0.9f, 0.5f * PL_PI_F)).x;
  assert_true(along > 20.0f * across);
}

/* A smooth coat over black: Fresnel's part of the light, and nothing else. */
static void test_coat_over_black(void **state) {
  (void)state;
  pl_surface s = plain(0.5f, 1.0f);
  s.color = pl_vec3f_make(0.0f, 0.0f, 0.0f);
  s.lobes.f90 = 0.0f;
  s.metallic = 0.0f;
  s.lobes.f0 = s.color;
  s.lobes.coat = 0.8f;
  s.lobes.coat_alpha = 0.0f;
  for (int i = 1; i <= 10; i++) {
    double energy[2];
    furnace(&s, tilted(0.1f * (float)i, 0.4f), energy);
    const double expected = 0.8 * fresnel(acos(0.1 * i), false);
    assert_true(fabs(energy[0] - expected) < 3e-3 && energy[1] == 0.0);
  }
}

/* A mirror of a coat turned by 15 degrees over black: the sun shows 30 degrees aside, not in the
 * base's mirror image. A coat whose normal is the surface's is the plain one. */
static void test_coat_has_its_own_normal(void **state) {
  (void)state;
  const float to_rad = PL_PI_F / 180.0f;
  pl_surface s = plain(0.5f, 0.0f);
  s.t = pl_vec3f_make(1.0f, 0.0f, 0.0f);
  s.b = pl_vec3f_make(0.0f, 1.0f, 0.0f);
  s.n = pl_vec3f_make(0.0f, 0.0f, 1.0f);
  s.color = s.lobes.f0 = pl_vec3f_make(0.0f, 0.0f, 0.0f);
  s.lobes.f90 = 0.0f;
  s.lobes.coat = 1.0f;
  s.lobes.coat_alpha = 0.01f;
  const pl_vec3f up = tilted(1.0f, 0.0f), aside = tilted(cosf(30.0f * to_rad), 0.0f);
  const float peak = row->evaluate(&s, up, up).x;
  s.lobes.coat_normal = s.n;
  assert_true(near(row->evaluate(&s, up, up).x, peak, 1e-5f));
  s.lobes.coat_normal = tilted(cosf(15.0f * to_rad), 0.0f);
  assert_true(row->evaluate(&s, up, up).x < 1e-4f * peak);
  assert_true(near(row->evaluate(&s, up, aside).x * cosf(15.0f * to_rad), peak, 3e-3f));
  double energy[2];
  furnace(&s, up, energy);
  assert_true(fabs(energy[0] - 0.04) < 1e-3);
}

/* A smooth boundary: Fresnel's part is mirrored, the rest goes on by Snell's law, from either side;
 * beyond the critical angle all is mirrored. */
static void test_smooth_boundary(void **state) {
  (void)state;
  for (int inside = 0; inside < 2; inside++)
    for (int degrees = 5; degrees <= 80; degrees += 15) {
      pl_surface s = plain(0.0f, 0.0f);
      s.lobes.transmission = 1.0f;
      s.lobes.ior = 1.5f;
      s.lobes.inside = inside;
      const double i = degrees * PL_PI / 180.0, sine = sin(i) * (inside ? 1.5 : 1.0 / 1.5);
      const double t = asin(fmin(sine, 1.0)), mirrored = fresnel(i, inside != 0);
      const pl_vec3f wo = tilted((float)cos(i), 0.4f);
      const float u[2] = {0.99f, 0.6f};
      pl_vec3f wi, weight;
      float pdf;
      double energy[2];
      furnace(&s, wo, energy);
      if (fabs(energy[0] - mirrored) > 3e-3 || fabs(energy[1] - 1.0 + mirrored) > 3e-3)
        fail_msg("%d deg: %g and %g, not %g", degrees, energy[0], energy[1], mirrored);
      if (sine < 1.0) {
        assert_true(row->sample(&s, wo, u, &wi, &weight, &pdf));
        const pl_vec3f on = pl_vec3f_scale(tilted((float)cos(t), 0.4f), -1.0f);
        assert_true(wi.z < 0.0f && pl_vec3f_norm(pl_vec3f_sub(wi, on)) < 0.02f);
      }
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_plain_is_metallic_roughness),
      cmocka_unit_test(test_ior_1_is_lambert),
      cmocka_unit_test(test_index),
      cmocka_unit_test(test_smooth_wall),
      cmocka_unit_test(test_white_furnace),
      cmocka_unit_test(test_white_furnace_of_dielectrics),
      cmocka_unit_test(test_same_as_mitsuba),
      cmocka_unit_test(test_anisotropy_has_a_direction),
      cmocka_unit_test(test_coat_over_black),
      cmocka_unit_test(test_coat_has_its_own_normal),
      cmocka_unit_test(test_smooth_boundary),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
