/* Facets: beside integrals over normally distributed slopes, light conserved, shares of slopes. */
#include "harness.h"

#include <math.h>

#include "shade/reflectance.h"
#include "shade/rough.h"

static const double DEGREE = PL_PI / 180.0;

static pl_surface surface_of(const pl_reflectance *model, double variance) {
  pl_surface s = {.t = {1.0f, 0.0f, 0.0f},
                  .b = {0.0f, 1.0f, 0.0f},
                  .n = {0.0f, 0.0f, 1.0f},
                  .ng = {0.0f, 0.0f, 1.0f},
                  .color = {0.2f, 0.3f, 0.4f},
                  .alpha = 1.0f,
                  .rough = {.variance = (float)variance, .whole = (float)variance},
                  .reflectance = model};
  for (int k = 0; k < 3; k++)
    s.regolith.band[k] = (pl_regolith_band){
        .b = 0.24f, .c = 0.33f, .b_s0 = 1.7f, .h_s = 0.07f, .roughness_rad = 0.41f};
  return s;
}

static pl_vec3f toward(double elevation_deg, double azimuth_deg) {
  const double e = elevation_deg * DEGREE, a = azimuth_deg * DEGREE;
  return (pl_vec3f){(float)(cos(e) * cos(a)), (float)(cos(e) * sin(a)), (float)sin(e)};
}

/* Smith's Lambda of normally distributed slopes. */
static double lambda(double deviation, pl_vec3f v) {
  const double x = (double)v.z / fmax(hypot((double)v.x, (double)v.y), 1e-9) / deviation;
  return 0.5 * (sqrt(2.0 / PL_PI) / x * exp(-0.5 * x * x) - erfc(x / sqrt(2.0)));
}

/* The integral over slopes, by steps, with the same rule for what is both lit and seen. */
static double integral(const pl_surface *s, double deviation, pl_vec3f wo, pl_vec3f wi) {
  enum { STEPS = 48 };
  pl_surface facet = *s;
  double sum = 0.0, weights = 0.0;
  facet.rough = (pl_rough){.whole = 0.0f};
  for (int i = 0; i < STEPS; i++)
    for (int j = 0; j < STEPS; j++) {
      const double x = 10.0 * (i + 0.5) / STEPS - 5.0, y = 10.0 * (j + 0.5) / STEPS - 5.0;
      const double weight = exp(-0.5 * (x * x + y * y));
      weights += weight;
      const pl_vec3f n =
          pl_vec3f_unit((pl_vec3f){(float)(-x * deviation), (float)(-y * deviation), 1.0f});
      const pl_vec3f t = pl_vec3f_unit(pl_vec3f_cross((pl_vec3f){0.0f, 1.0f, 0.0f}, n));
      const pl_vec3f b = pl_vec3f_cross(n, t);
      const pl_vec3f o = {pl_vec3f_dot(t, wo), pl_vec3f_dot(b, wo), pl_vec3f_dot(n, wo)};
      const pl_vec3f l = {pl_vec3f_dot(t, wi), pl_vec3f_dot(b, wi), pl_vec3f_dot(n, wi)};
      if (o.z > 0.0f && l.z > 0.0f)
        sum += weight * (double)(o.z / (n.z * wo.z)) *
               (double)s->reflectance->evaluate(&facet, o, l).y;
    }
  const double lit = lambda(deviation, wi), seen = lambda(deviation, wo);
  const double cross = (double)(wo.x * wi.y - wo.y * wi.x);
  const double apart = 4.41 * fabs(atan2(cross, (double)(wo.x * wi.x + wo.y * wi.y)));
  return sum / weights / (1.0 + fmax(lit, seen) + apart / (1.0 + apart) * fmin(lit, seen));
}

/* Four facets are within a few per cent of the integral; the plane alone is not. */
static void test_integral(void **state) {
  (void)state;
  const pl_reflectance *const models[] = {&pl_reflectance_hapke, &pl_reflectance_lambert,
                                          &pl_reflectance_lommel_seeliger};
  const double deviations[] = {0.05, 0.13, 0.2}, suns[] = {2, 5, 10, 20, 30, 45, 70};
  const double views[][2] = {{89.9, 0}, {45, 3}, {45, 90}, {45, 180}, {25, 120}};
  double plane = 0.0;
  for (int m = 0; m < 3; m++)
    for (int d = 0; d < 3; d++)
      for (int i = 0; i < 7; i++)
        for (int v = 0; v < 5; v++) {
          const pl_surface s = surface_of(models[m], deviations[d] * deviations[d]);
          const pl_surface flat = surface_of(models[m], 0.0);
          const pl_vec3f wi = toward(suns[i], 0.0), wo = toward(views[v][0], views[v][1]);
          const double exact = integral(&s, deviations[d], wo, wi);
          const double got = (double)models[m]->evaluate(&s, wo, wi).y;
          assert_true(fabs(got / exact - 1.0) < (deviations[d] < 0.15 ? 0.025 : 0.06));
          plane = fmax(plane, fabs((double)models[m]->evaluate(&flat, wo, wi).y / exact - 1.0));
        }
  assert_true(plane > 0.2);
}

/* A mean over places with mean slopes of their own is that of all slopes together: it does not
 * matter which part of them is known. */
static void test_shares(void **state) {
  (void)state;
  enum { STEPS = 24 };
  const double suns[] = {5, 15, 40}, limits[] = {0.06, 0.012, 0.003};
  for (int i = 0; i < 3; i++) {
    const pl_vec3f wi = toward(suns[i], 20.0), wo = toward(60.0, 110.0);
    const pl_surface all = surface_of(&pl_reflectance_hapke, 0.02);
    pl_surface part = surface_of(&pl_reflectance_hapke, 0.005);
    double sum = 0.0, weights = 0.0;
    part.rough.whole = 0.02f;
    for (int a = 0; a < STEPS; a++)
      for (int b = 0; b < STEPS; b++) {
        const double x = 8.0 * (a + 0.5) / STEPS - 4.0, y = 8.0 * (b + 0.5) / STEPS - 4.0;
        const double weight = exp(-0.5 * (x * x + y * y)), size = sqrt(0.015);
        part.rough.slope = (pl_vec3f){(float)(size * x), (float)(size * y), 0.0f};
        sum += weight * (double)pl_reflectance_hapke.evaluate(&part, wo, wi).y;
        weights += weight;
      }
    const double together = (double)pl_reflectance_hapke.evaluate(&all, wo, wi).y;
    assert_true(fabs(sum / weights / together - 1.0) < limits[i]);
  }
}

/* Lambert's ground sends back into all directions what a plane does, but for what facets of a
 * slope lose by facing each other; fewer facets are lit at a low sun, not less light received. */
static void test_light_is_conserved(void **state) {
  (void)state;
  for (double sun = 0.5; sun < 90.0; sun *= 1.7) {
    const pl_surface s = surface_of(&pl_reflectance_lambert, 0.01);
    const pl_vec3f wi = toward(sun, 0.0);
    const double down = (double)pl_reflectance_lambert.evaluate(&s, toward(89.99, 0.0), wi).y;
    assert_true(fabs(down / (0.3 * sin(sun * DEGREE) / PL_PI) - 0.99) < 0.004);
  }
}

/* No facets, none steep, directions at and below the horizon, known slopes that face away. */
static void test_ends(void **state) {
  (void)state;
  const pl_surface flat = surface_of(&pl_reflectance_hapke, 0.0);
  const pl_surface nearly = surface_of(&pl_reflectance_hapke, 1e-10);
  pl_surface rough = surface_of(&pl_reflectance_hapke, 0.04);
  const pl_vec3f wo = toward(50.0, 30.0), wi = toward(40.0, 200.0), up = {0.0f, 0.0f, 1.0f};
  const float a = pl_reflectance_hapke.evaluate(&flat, wo, wi).y;
  assert_true(fabsf(pl_reflectance_hapke.evaluate(&nearly, wo, wi).y / a - 1.0f) < 1e-4f);
  assert_true(pl_reflectance_hapke.evaluate(&rough, up, up).y > 0.0f);
  assert_true(pl_reflectance_hapke.evaluate(&rough, wo, toward(0.0, 10.0)).y == 0.0f);
  assert_true(pl_reflectance_hapke.evaluate(&rough, wo, toward(-3.0, 10.0)).y == 0.0f);
  const float low = pl_reflectance_hapke.evaluate(&rough, wo, toward(1e-4, 10.0)).y;
  assert_true(low > 0.0f && low < 1e-4f);
  rough.rough.variance = 0.0f;
  rough.rough.slope = (pl_vec3f){-50.0f, 0.0f, 0.0f}; /* a wall that faces east */
  assert_true(pl_reflectance_hapke.evaluate(&rough, toward(45.0, 180.0), up).y == 0.0f);
}

/* Beside frames of rocks of 0.8 to 1.25 m with all of them in the mesh, from straight above: means
 * of radiance over that of bare ground, by 16 000 m^2 with 1000 rocks. */
static void test_stones_beside_meshes(void **state) {
  (void)state;
  const double suns[] = {5, 10, 20, 30, 45, 70, 90};
  const double means[] = {0.8330, 0.9077, 0.9493, 0.9644, 0.9754, 0.9844, 0.9880};
  const pl_surface bare = surface_of(&pl_reflectance_lambert, 0.0);
  pl_surface s = bare;
  s.rough = (pl_rough){.stones = 0.0422f, .stone_height = 0.445f, .stone_relief = 0.286f};
  for (int i = 0; i < 7; i++) {
    const pl_vec3f wi = toward(suns[i], 0.0), wo = toward(90.0, 0.0);
    const double got = (double)(pl_reflectance_lambert.evaluate(&s, wo, wi).y /
                                pl_reflectance_lambert.evaluate(&bare, wo, wi).y);
    if (!(fabs(got - means[i]) < 0.003))
      fail_msg("Sun at %g degrees: %g, not %g", suns[i], got, means[i]);
  }
}

/* More rocks take more light, and less than in proportion; never all. */
static void test_stones(void **state) {
  (void)state;
  const double suns[] = {5, 10, 20, 40, 70}, heights[] = {0.3, 0.45, 0.55};
  for (int i = 0; i < 5; i++)
    for (int h = 0; h < 3; h++) {
      const pl_vec3f wi = toward(suns[i], 0.0), wo = toward(89.99, 0.0);
      pl_surface s = surface_of(&pl_reflectance_lambert, 0.0);
      const double bare = (double)pl_reflectance_lambert.evaluate(&s, wo, wi).y;
      s.rough.stone_height = (float)heights[h];
      double before = 0.0, per_stone = 0.0;
      for (double share = 0.002; share < 0.5; share *= 4.0) {
        s.rough.stones = (float)share;
        const double taken = 1.0 - (double)pl_reflectance_lambert.evaluate(&s, wo, wi).y / bare;
        assert_true(taken > before && taken < 1.0);
        per_stone = before == 0.0 ? taken / share : per_stone;
        assert_true(taken <= 1.001 * per_stone * share);
        before = taken;
      }
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_integral),
      cmocka_unit_test(test_shares),
      cmocka_unit_test(test_light_is_conserved),
      cmocka_unit_test(test_ends),
      cmocka_unit_test(test_stones),
      cmocka_unit_test(test_stones_beside_meshes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
