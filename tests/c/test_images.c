/* Images against what they must be: analytic radiance, projected vertices, the sun's disc. */
#include "harness.h"

#include <stdio.h>

#include "frames.h"
#include "geom/ellipsoid.h"

static const double AU = 149597870700.0, SUN_RADIUS_M = 695700e3, SOLAR = 1361.0;

static film shoot(const stage *s, int samples, int max_bounces, pl_effect_set force_on) {
  film f;
  pl_renderer *renderer;
  film_init(&f, s);
  pl_frame_request request = request_all(s, &f);
  request.samples = samples;
  request.max_bounces = max_bounces;
  request.wish = (pl_plan_wish){.tolerance_dn = 0.0, .force_on = force_on};
  assert_int_equal(pl_renderer_create(&s->scene, &renderer), PL_OK);
  render(renderer, &request);
  pl_renderer_destroy(renderer);
  return f;
}

/* --- Lambert spheres -------------------------------------------------------------------------- */

/* Mean of max(cos, 0) over a disc of angular radius a whose centre stands at sine `height` over the
 * horizon: the part of a half disc where it is cut (e.g. Wikipedia, "Circular segment"). */
static double lit_cosine(double height, double a) {
  const double x = height / a;
  if (x >= 1.0)
    return height;
  if (x <= -1.0)
    return 0.0;
  const double root = sqrt(1.0 - x * x);
  return a / PL_PI * (x * (PL_PI / 2.0 + asin(x) + x * root) + 2.0 / 3.0 * root * root * root);
}

/* Radiance of albedo-0.5 Lambert sphere along a camera ray. */
static double sphere_radiance(const stage *s, double radius, pl_vec3 center, double u, double v) {
  const pl_vec3 d = pl_vec3_unit(pl_camera_ray(&s->placement.camera, u, v));
  const pl_vec3 r = {radius, radius, radius};
  double t;
  if (!pl_ellipsoid_intersect(r, pl_vec3_scale(center, -1.0), d, 0.0, &t))
    return 0.0;
  const pl_vec3 p = pl_vec3_scale(d, t);
  const pl_vec3 n = pl_vec3_unit(pl_vec3_sub(p, center));
  const pl_vec3 to_sun = pl_vec3_sub(s->placement.sun.position_m, p);
  const double distance = pl_vec3_norm(to_sun);
  const double irradiance = SOLAR * (AU / distance) * (AU / distance);
  const double height = pl_vec3_dot(n, to_sun) / distance;
  return 0.5 / PL_PI * irradiance * lit_cosine(height, SUN_RADIUS_M / distance);
}

enum { FINE = 64 };

/* As the plan renders it and with every effect forced on, every pixel against the mean of FINE^2
 * analytic points. The 256 samples of a pixel that an edge
 * crosses are off by less than 0.02 of the step (the discrepancy of half planes is about
 * n^(-3/4) = 0.016), all others by the variation within the pixel over as much. */
static void check_sphere(double focal, double distance, double radius, pl_vec3 shift, pl_vec3 sun) {
  stage s;
  stage_init(&s, 48, 40, focal);
  const pl_vec3 center = {shift.x, shift.y, distance};
  s.placement.sun.position_m = pl_vec3_scale(pl_vec3_unit(sun), AU);
  stage_add_body(&s, center, (pl_vec3){radius, radius, radius}, 0.5f);
  film films[2] = {shoot(&s, 256, 2, no_effects()), shoot(&s, 256, 2, all_effects())};
  double flux[2] = {0.0}, expected_flux = 0.0, worst = 0.0;
  for (int y = 0; y < 40; y++)
    for (int x = y % PL_DRAWS(1, 3); x < 48; x += PL_DRAWS(1, 3)) {
      double mean = 0.0, low = INFINITY, high = 0.0;
      for (int i = 0; i < FINE * FINE; i++) {
        const double value = sphere_radiance(&s, radius, center, x + (i % FINE + 0.5) / FINE - 0.5,
                                             y + ((double)(i / FINE) + 0.5) / FINE - 0.5);
        mean += value / (FINE * FINE);
        low = fmin(low, value);
        high = fmax(high, value);
      }
      const double tolerance = 0.03 * (high - low) + 1e-4 * high +
                               1e-3 * SOLAR * 0.5 / PL_PI * (high < 0.02 * SOLAR ? 1.0 : 0.0);
      for (int forced = 0; forced < 2; forced++) {
        const double value = (double)films[forced].radiance[3 * (y * 48 + x)];
        worst = fmax(worst, fabs(value - mean) / (tolerance + 1e-12));
        if (fabs(value - mean) > tolerance)
          fail_msg("pixel %d %d%s: %.6f, expected %.6f +- %.6f", x, y, forced ? ", forced" : "",
                   value, mean, tolerance);
        flux[forced] += value;
      }
      expected_flux += mean;
    }
  print_message("worst pixel %.2f of its tolerance, flux off by %.2g and %.2g\n", worst,
                flux[0] / expected_flux - 1.0, flux[1] / expected_flux - 1.0);
  /* Of a sphere of a few pixels most is outline: there 256 points of a net err by up to 256^-0.75.
   */
  assert_true(expected_flux > 0.0);
  for (int forced = 0; forced < 2; forced++) {
    assert_true(fabs(flux[forced] / expected_flux - 1.0) < PL_DRAWS(5e-3, 0.02));
    film_clear(&films[forced]);
  }
  stage_clear(&s);
}

static void test_lambert_sphere(void **state) {
  (void)state;
  const pl_vec3 none = {0, 0, 0};
  check_sphere(100.0, 1e7, 1.6e6, none, (pl_vec3){1, -0.4, -0.5});   /* 16 px, 60 deg phase */
  check_sphere(5000.0, 1e8, 6.4e6, none, (pl_vec3){1, 0.1, -0.005}); /* terminator */
  if (PL_DRAWS(0, 1))
    return;
  check_sphere(100.0, 1e7, 1.6e6, none, (pl_vec3){0.3, 0.2, -1});  /* nearly full */
  check_sphere(100.0, 1e7, 1.6e6, none, (pl_vec3){0.6, 0.2, 0.8}); /* a crescent */
  check_sphere(100.0, 1e7, 2e5, none, (pl_vec3){1, 0, -0.5});      /* 2 px */
  check_sphere(5000.0, 1e8, 6.4e6, (pl_vec3){6.4e6, 0, 0}, (pl_vec3){-0.2, 1, -0.6}); /* limb */
}

/* --- a cube's mask ---------------------------------------------------------------------------- */

typedef struct point2 {
  double u, v;
} point2;

static double turn_of(point2 a, point2 b, point2 p) {
  return (b.u - a.u) * (p.v - a.v) - (b.v - a.v) * (p.u - a.u);
}

/* Signed distance to the convex hull of projected points, positive inside, in pixels: every pair
 * that has all others on one side is an edge. */
static double hull_distance(const point2 *points, int count, point2 p) {
  double least = INFINITY;
  for (int i = 0; i < count; i++)
    for (int k = 0; k < count; k++) {
      const double length = hypot(points[k].u - points[i].u, points[k].v - points[i].v);
      bool edge = length > 1e-9;
      for (int m = 0; m < count && edge; m++)
        edge = turn_of(points[i], points[k], points[m]) > -1e-9;
      if (edge)
        least = fmin(least, turn_of(points[i], points[k], p) / length);
    }
  return least;
}

static void test_cube_projects_on_its_mask(void **state) {
  (void)state;
  test_random random = {.seed = 92};
  pl_model *model = cube_create(0.5);
  int inside = 0, outside = 0;
  print_message("seed 92\n");
  for (int round = 0; round < PL_DRAWS(20, 4); round++) {
    stage s;
    stage_init(&s, 64, 56, 70.0);
    s.placement.camera.skew = 3.0;
    const pl_pose camera = {pl_vec3_scale(random_direction(&random), 1.5e11),
                            random_rotation(&random)};
    s.placement.camera.motion = (pl_motion){.open = camera, .close = camera};
    const pl_vec3 place = {random_range(&random, -1, 1), random_range(&random, -1, 1),
                           random_range(&random, 4, 20)};
    stage_add_object(&s, model, pose_apply(camera, place), random_rotation(&random), 3.0);
    const double metre = 3.0517578125e-5; /* ulp of the camera's position */
    film f = shoot(&s, 1, 0, no_effects());
    const pl_object_label *label = &f.objects[0];
    point2 points[24];
    for (size_t i = 0; i < 24; i++) {
      const pl_vec3 p = pl_vec3_scale(model_vertex(model, i), 3.0);
      const double *r = label->R_m2c, *t = label->t_m2c;
      const double x = r[0] * p.x + r[1] * p.y + r[2] * p.z + t[0];
      const double y = r[3] * p.x + r[4] * p.y + r[5] * p.z + t[1];
      const double z = r[6] * p.x + r[7] * p.y + r[8] * p.z + t[2];
      const pl_camera *c = &s.placement.camera;
      points[i] = (point2){(c->fx * x + c->skew * y) / z + c->cx, c->fy * y / z + c->cy};
    }
    assert_true(fabs(label->t_m2c[2] - place.z) < 4 * metre);
    const int32_t *instance = film_channel(&f, "instance");
    int32_t box[4] = {64, 56, -1, -1}, count = 0;
    for (int y = 0; y < 56; y++)
      for (int x = 0; x < 64; x++) {
        const double gap = hull_distance(points, 24, (point2){x, y});
        const bool seen = instance[y * 64 + x] == 1;
        if (fabs(gap) > 1e-3 && seen != (gap > 0.0))
          fail_msg("pixel %d %d is %sin the mask, %.4f px inside the hull", x, y,
                   seen ? "" : "not ", gap);
        inside += seen;
        outside += !seen;
        count += seen;
        if (seen) {
          box[0] = x < box[0] ? x : box[0];
          box[1] = y < box[1] ? y : box[1];
          box[2] = x > box[2] ? x : box[2];
          box[3] = y > box[3] ? y : box[3];
        }
      }
    assert_int_equal(label->px_count_visib, count);
    assert_int_equal(label->bbox_visib[0], box[0]);
    assert_int_equal(label->bbox_visib[1], box[1]);
    assert_int_equal(label->bbox_visib[2], box[2] - box[0]);
    assert_int_equal(label->bbox_visib[3], box[3] - box[1]);
    film_clear(&f);
    stage_clear(&s);
  }
  assert_true(inside > PL_DRAWS(2000, 200) && outside > PL_DRAWS(10000, 2000));
  pl_model_destroy(model);
}

/* --- light ------------------------------------------------------------------------------------ */

/* The sun in the frame: its irradiance at the camera is the flux of its image. */
static void test_sun_disc(void **state) {
  (void)state;
  stage s;
  stage_init(&s, 64, 64, 3000.0); /* the disc is 28 px across */
  s.placement.sun.position_m = (pl_vec3){0.0005 * AU, -0.001 * AU, AU};
  film f = shoot(&s, 256, 0, no_effects());
  double irradiance = 0.0;
  for (int y = 0; y < 64; y++)
    for (int x = 0; x < 64; x++) {
      const pl_vec3 d = pl_camera_ray(&s.placement.camera, x, y);
      const double cosine = 1.0 / pl_vec3_norm(d);
      irradiance += (double)f.radiance[3 * (y * 64 + x)] * cosine * cosine * cosine / 9e6;
    }
  print_message("sun: %.4f of %.1f W m-2\n", irradiance, SOLAR);
  assert_true(fabs(irradiance / SOLAR - 1.0) < 2e-3);
  film_clear(&f);
  stage_clear(&s);
}

/* A mirror turned to show the sun: its glint is the sun's radiance, however many bounces are
 * allowed, since light from the sun to the mirror to the camera has none. */
static void test_glint_needs_no_bounce(void **state) {
  (void)state;
  pl_model *model = square_create(1.0);
  model->materials[0].metallic = 1.0f;
  double peak[2][2];
  for (int rough = 0; rough < 2; rough++) {
    model->materials[0].roughness = rough ? 0.25f : 0.05f;
    for (int k = 0; k < 3; k++)
      model->materials[0].base_color[k] = 1.0f;
    for (int bounces = 0; bounces < 2; bounces++) {
      stage s;
      stage_init(&s, 16, 16, 3000.0);
      s.placement.sun.position_m = (pl_vec3){AU, 0, 0};
      /* The normal halves the angle between the camera (-z) and the sun (+x). */
      stage_add_object(&s, model, (pl_vec3){0, 0, 10},
                       pl_quat_axis_angle((pl_vec3){0, 1, 0}, 0.75 * PL_PI), 1.0);
      film f = shoot(&s, 1024, bounces, no_effects());
      peak[rough][bounces] = (double)f.radiance[3 * (8 * 16 + 8)];
      film_clear(&f);
      stage_clear(&s);
    }
    print_message("glint: %.5g without, %.5g with a bounce\n", peak[rough][0], peak[rough][1]);
  }
  const double sun = SOLAR / (PL_PI * SUN_RADIUS_M * SUN_RADIUS_M / (AU * AU));
  assert_true(peak[0][1] > 0.5 * sun && peak[0][1] < 1.02 * sun);
  for (int rough = 0; rough < 2; rough++)
    assert_true(fabs(peak[rough][0] / peak[rough][1] - 1.0) < 0.02);
  pl_model_destroy(model);
}

/* A body that glows is seen at its own radiance. */
static void test_emission(void **state) {
  (void)state;
  stage s;
  stage_init(&s, 16, 16, 20.0);
  stage_add_body(&s, (pl_vec3){0, 0, 10}, (pl_vec3){8, 8, 8}, 0.0f);
  s.bodies[0].emission[0] = s.bodies[0].emission[1] = 40.0f;
  film f = shoot(&s, 4, 2, all_effects());
  for (size_t i = 0; i < f.pixels; i++)
    assert_true(fabsf(f.radiance[3 * i] - 40.0f) < 1e-3f && f.radiance[3 * i + 2] == 0.0f);
  film_clear(&f);
  stage_clear(&s);
}

/* A body in the umbra of another is black; beside the penumbra it is not. */
static void test_eclipse(void **state) {
  (void)state;
  for (int aside = 0; aside < 2; aside++) {
    stage s;
    stage_init(&s, 16, 16, 100.0);
    s.placement.sun.position_m = (pl_vec3){0, AU, -0.2 * AU};
    const pl_vec3 toward = pl_vec3_unit(s.placement.sun.position_m);
    stage_add_body(&s, (pl_vec3){0, 0, 1e7}, (pl_vec3){2e6, 2e6, 2e6}, 0.5f);
    const pl_vec3 caster = pl_vec3_madd((pl_vec3){0, 0, 1e7}, 2e8, toward);
    stage_add_body(&s, (pl_vec3){caster.x + (aside ? 9e6 : 0.0), caster.y, caster.z},
                   (pl_vec3){4e6, 4e6, 4e6}, 0.5f);
    film f = shoot(&s, 16, 0, no_effects());
    const float value = f.radiance[3 * (13 * 16 + 8)];
    if (aside)
      assert_true(value > 10.0f);
    else
      assert_true(value == 0.0f);
    film_clear(&f);
    stage_clear(&s);
  }
}

/* Pixels that end early stay within the tolerance of the exact samples: a sphere with a terminator,
 * a cube before it, half a digital number of rounding on either side. */
static void test_tolerance_is_kept(void **state) {
  (void)state;
  pl_model *model = cube_create(0.5);
  model->materials[0].lambert = true; /* Lambert: no noise but the sun's disc */
  uint8_t pictures[2][48 * 40 * 3];
  for (int exact = 0; exact < 2; exact++) {
    stage s;
    stage_init(&s, 48, 40, 60.0);
    s.placement.sun.position_m = (pl_vec3){AU, 0.3 * AU, -0.6 * AU};
    stage_add_body(&s, (pl_vec3){0, 0, 40}, (pl_vec3){12, 12, 11}, 0.5f);
    stage_add_object(&s, model, (pl_vec3){1, 1, 14},
                     pl_quat_axis_angle((pl_vec3){0.6, 0.8, 0}, 0.7), 4.0);
    film f;
    pl_renderer *renderer;
    film_init(&f, &s);
    pl_frame_request request = request_all(&s, &f);
    request.samples = 256;
    request.max_bounces = 0;
    request.wish = (pl_plan_wish){.tolerance_dn = exact ? 0.0 : 1.0};
    assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
    render(renderer, &request);
    memcpy(pictures[exact], f.rgb, sizeof pictures[exact]);
    pl_renderer_destroy(renderer);
    film_clear(&f);
    stage_clear(&s);
  }
  int beyond = 0;
  double square = 0.0;
  for (size_t i = 0; i < sizeof pictures[0]; i++) {
    const int step = abs((int)pictures[0][i] - (int)pictures[1][i]);
    square += (double)(step * step);
    beyond += step > 2;
  }
  print_message("RMS %.3f DN, %d values beyond 2 DN\n", sqrt(square / sizeof pictures[0]), beyond);
  assert_true(sqrt(square / sizeof pictures[0]) < 1.0);
  assert_true(beyond < (int)sizeof pictures[0] / 50); /* outlines */
  pl_model_destroy(model);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_lambert_sphere), cmocka_unit_test(test_cube_projects_on_its_mask),
      cmocka_unit_test(test_sun_disc),       converging_unit_test(test_glint_needs_no_bounce),
      cmocka_unit_test(test_emission),       cmocka_unit_test(test_tolerance_is_kept),
      cmocka_unit_test(test_eclipse),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
