/* The penumbra of a sphere against the overlap of two discs. */
#include "harness.h"

#include <stdio.h>

#include "frame/effects.h"
#include "frames.h"
#include "geom/ellipsoid.h"

enum { SIDE = 48, FINE = PL_DRAWS(8, 4) };
static const double AU = 149597870700.0, SUN_RADIUS_M = 695700e3, SOLAR = 1361.0;
static const double GROUND_Z = 100.0;

/* The part of a disc of radius a that a disc of radius b hides, their centres d apart (the lens of
 * two circles, e.g. Weisstein, "Circle-Circle Intersection", MathWorld, eq. 14, over pi a^2). */
static double hidden_part(double a, double b, double d) {
  if (d >= a + b)
    return 0.0;
  if (d <= fabs(a - b))
    return b >= a ? 1.0 : b * b / (a * a);
  const double x = (d * d + a * a - b * b) / (2.0 * d * a);
  const double y = (d * d + b * b - a * a) / (2.0 * d * b);
  const double root = sqrt((a + b - d) * (d + a - b) * (d - a + b) * (d + a + b));
  return (a * a * acos(x) + b * b * acos(y) - 0.5 * root) / (PL_PI * a * a);
}

/* The same of a disc that darkens towards its edge, by 400 rings: the arc of each that is hidden,
 * weighted by Neckel's polynomial (2005) at 0.4226 um over its mean. */
static double hidden_light(double a, double b, double d) {
  enum { RINGS = 400 };
  const double l = 0.4226, l5 = l * l * l * l * l;
  const double k[6] = {0.75267 - 0.265577 / l,   0.93874 + 0.265577 / l - 0.004095 / l5,
                       -1.89287 + 0.012582 / l5, 2.42234 - 0.017117 / l5,
                       -1.71150 + 0.011977 / l5, 0.49062 - 0.003347 / l5};
  double hidden = 0.0, all = 0.0;
  for (int i = 0; i < RINGS; i++) {
    const double r = a * (i + 0.5) / RINGS, mu = sqrt(1.0 - r * r / (a * a));
    double light = 0.0;
    for (int j = 5; j >= 0; j--)
      light = light * mu + k[j];
    const double cosine = (r * r + d * d - b * b) / (2.0 * r * d);
    const double arc = cosine >= 1.0 ? 0.0 : cosine <= -1.0 ? 1.0 : acos(cosine) / PL_PI;
    hidden += light * r * arc;
    all += light * r;
  }
  return hidden / all;
}

typedef struct shadow_case {
  const char *name;
  double caster_radius, caster_distance; /* m */
  bool on_body;                          /* the receiver is a large sphere instead of a mesh */
  pl_effect_set force_on;
  bool limb; /* the disc darkens towards its edge */
} shadow_case;

static const double RECEIVER_RADIUS = 1e5;

static pl_vec3 sun_direction(void) { return pl_vec3_unit((pl_vec3){0.5, 0.2, -0.8}); }
static pl_vec3 caster_at(const shadow_case *c) {
  return pl_vec3_madd((pl_vec3){0, 0, GROUND_Z}, c->caster_distance, sun_direction());
}

static void receiver_hit(const shadow_case *c, pl_vec3 d, pl_vec3 *point, pl_vec3 *normal) {
  const pl_vec3 center = {0, 0, GROUND_Z + RECEIVER_RADIUS};
  double t = GROUND_Z / d.z;
  if (c->on_body) {
    const pl_vec3 r = {RECEIVER_RADIUS, RECEIVER_RADIUS, RECEIVER_RADIUS};
    assert_true(pl_ellipsoid_intersect(r, pl_vec3_scale(center, -1.0), d, 0.0, &t));
  }
  *point = pl_vec3_scale(d, t);
  *normal = c->on_body ? pl_vec3_unit(pl_vec3_sub(*point, center)) : (pl_vec3){0, 0, -1};
}

static double angle_between(pl_vec3 a, pl_vec3 b) {
  return atan2(pl_vec3_norm(pl_vec3_cross(a, b)), pl_vec3_dot(a, b));
}

/* Sunlight on albedo 0.5; `light` is the visible part of the sun. Treating cosine as constant over
 * the disc and angles as plane leaves less than 1e-4. */
static double expected_radiance(const shadow_case *c, const stage *s, double u, double v,
                                double *light) {
  pl_vec3 point, normal;
  receiver_hit(c, pl_camera_ray(&s->placement.camera, u, v), &point, &normal);
  const pl_vec3 to_sun = pl_vec3_sub(s->placement.sun.position_m, point);
  const pl_vec3 to_caster = pl_vec3_sub(caster_at(c), point);
  const double sun = asin(SUN_RADIUS_M / pl_vec3_norm(to_sun));
  const double caster = asin(c->caster_radius / pl_vec3_norm(to_caster));
  *light =
      1.0 - (c->limb ? hidden_light : hidden_part)(sun, caster, angle_between(to_sun, to_caster));
  return *light * 0.5 / PL_PI * SOLAR * pl_vec3_dot(pl_vec3_unit(to_sun), normal);
}

static film shoot(const shadow_case *c, stage *s, const pl_model *ground) {
  film f;
  pl_renderer *renderer;
  stage_init(s, SIDE, SIDE, 160.0);
  s->placement.sun.position_m = pl_vec3_scale(sun_direction(), AU);
  const double r = c->caster_radius;
  stage_add_body(s, caster_at(c), (pl_vec3){r, r, r}, 0.0f);
  if (c->on_body)
    stage_add_body(s, (pl_vec3){0, 0, GROUND_Z + RECEIVER_RADIUS},
                   (pl_vec3){RECEIVER_RADIUS, RECEIVER_RADIUS, RECEIVER_RADIUS}, 0.5f);
  else
    stage_add_object(s, ground, (pl_vec3){0, 0, GROUND_Z}, PL_QUAT_IDENTITY, 1.0);
  film_init(&f, s);
  pl_frame_request request = request_all(s, &f);
  request.samples = 256;
  request.max_bounces = 0;
  const pl_effect_set limb = one_effect("limb_darkening");
  const pl_effect_set off = c->limb ? no_effects() : limb;
  request.wish = (pl_plan_wish){
      .tolerance_dn = 0.0, .force_on = effects_without(c->force_on, off), .force_off = off};
  assert_int_equal(pl_renderer_create(&s->scene, &renderer), PL_OK);
  render(renderer, &request);
  pl_renderer_destroy(renderer);
  return f;
}

/* 256 samples in stratified pairs miss the lens by less than 0.03 of the disc (their discrepancy
 * for convex regions is below 2 n^(-3/4) = 0.03). */
static void check_penumbra(const shadow_case *c, const pl_model *ground) {
  stage s;
  film f = shoot(c, &s, ground);
  double worst = 0.0, sum = 0.0, expected_sum = 0.0;
  int partial = 0, dark = 0, full = 0;
  const double unshadowed = 0.5 / PL_PI * SOLAR;
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++) {
      double expected = 0.0, mean_light = 0.0, light;
      for (int i = 0; i < FINE * FINE; i++) {
        expected += expected_radiance(c, &s, x + (i % FINE + 0.5) / FINE - 0.5,
                                      y + ((double)(i / FINE) + 0.5) / FINE - 0.5, &light) /
                    (FINE * FINE);
        mean_light += light / (FINE * FINE);
      }
      const double value = (double)f.radiance[3 * (y * SIDE + x)];
      partial += mean_light > 0.01 && mean_light < 0.99;
      dark += mean_light == 0.0;
      full += mean_light == 1.0;
      assert_true(mean_light > 0.0 || value == 0.0);
      worst = fmax(worst, fabs(value - expected) / unshadowed);
      sum += value;
      expected_sum += expected;
    }
  print_message("%s: %d pixels in penumbra, %d in umbra, %d lit: worst off by %.4f, flux by %.2g\n",
                c->name, partial, dark, full, worst, sum / expected_sum - 1.0);
  assert_true(partial > 200 && full > 100);
  assert_true(worst < 0.03);
  assert_true(fabs(sum / expected_sum - 1.0) < 1e-3);
  film_clear(&f);
  stage_clear(&s);
}

static void test_penumbra(void **state) {
  (void)state;
  pl_model *ground = square_create(300.0);
  ground->materials[0].lambert = true; /* Lambert */
  const pl_effect_set all = all_effects(), none = no_effects();
  const shadow_case cases[] = {
      {"umbra on a mesh", 8.0, 1000.0, false, none, false},
      {"annular on a mesh", 5.0, 1500.0, false, none, false},
      {"umbra on a mesh, all effects", 8.0, 1000.0, false, all, false},
      {"umbra on a body", 8.0, 1000.0, true, none, false},
      {"annular on a body, all effects", 5.0, 1500.0, true, all, false},
      {"umbra on a mesh, darkened limb", 8.0, 1000.0, false, none, true},
      {"annular on a body, darkened limb", 5.0, 1500.0, true, none, true},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i += PL_DRAWS(1, 3))
    check_penumbra(&cases[i], ground);
  pl_model_destroy(ground);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_penumbra)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
