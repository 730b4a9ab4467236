/* Emissive surfaces as lights: densities, and images against exact irradiances. */
#include "harness.h"

#include "plan/effects.h"
#include <stdio.h>

#include "frames.h"
#include "light/emitters.h"
#include "math/color.h"
#include "render/geometry.h"

enum { SIDE = 24, SAMPLES = PL_DRAWS(256, 64) };

/* Of the brightest pixel, and of the mean. Draws of the lamp spread by less than 1 of the mean:
 * 0.06 for 256 independent samples, 5 sigma 0.3; the stratified ones stay below a tenth of that. */
static const double PIXEL_OFF = PL_DRAWS(0.03, 0.12), MEAN_OFF = PL_DRAWS(1e-3, 4e-3);
static const float RADIANCE = 50.0f; /* W m-2 sr-1 */

/* The stage without a sun. */
static void dark_stage(stage *s, double focal_px) {
  stage_init(s, SIDE, SIDE, focal_px);
  s->placement.sun.irradiance_au = 0.0;
}

/* Black lamp whose front emits; its back is not there. */
static pl_model *lamp_create(double half) {
  pl_model *model = square_create(half);
  pl_material *m = &model->materials[0];
  m->lambert = true;
  m->double_sided = false;
  for (int k = 0; k < 3; k++) {
    m->base_color[k] = 0.0f;
    m->emissive[k] = RADIANCE;
  }
  return model;
}

/* Lambert ground of albedo 0.5. */
static pl_model *ground_create(double half) {
  pl_model *model = square_create(half);
  model->materials[0].lambert = true;
  return model;
}

static film shoot(const stage *s, int samples, int max_bounces, pl_effect_set on, pl_effect_set off,
                  pl_plan *plan) {
  film f;
  pl_renderer *renderer;
  film_init(&f, s);
  pl_frame_request request = request_all(s, &f);
  request.samples = samples;
  request.max_bounces = max_bounces;
  request.wish = (pl_plan_wish){0.0, on, off};
  assert_int_equal(pl_renderer_create(&s->scene, &renderer), PL_OK);
  const pl_frame_result result = render(renderer, &request);
  if (plan != NULL)
    *plan = result.plan;
  pl_renderer_destroy(renderer);
  return f;
}

static double mean_of(const film *f) {
  double sum = 0.0;
  for (size_t i = 0; i < f->pixels; i++)
    sum += (double)f->radiance[3 * i];
  return sum / (double)f->pixels;
}

/* Irradiance of a Lambert polygon wholly above the horizon: L/2 times the sum over edges of the
 * angle they subtend times the cosine of their plane's normal (Lambert 1760; Howell, "A catalog of
 * radiation heat transfer configuration factors", B-5). */
static double polygon_irradiance(const pl_vec3 *corner, int count, pl_vec3 point, pl_vec3 normal) {
  double sum = 0.0;
  for (int i = 0; i < count; i++) {
    const pl_vec3 a = pl_vec3_unit(pl_vec3_sub(corner[i], point));
    const pl_vec3 b = pl_vec3_unit(pl_vec3_sub(corner[(i + 1) % count], point));
    const pl_vec3 across = pl_vec3_cross(a, b);
    const double angle = atan2(pl_vec3_norm(across), pl_vec3_dot(a, b));
    sum += angle * pl_vec3_dot(pl_vec3_unit(across), normal);
  }
  return 0.5 * (double)RADIANCE * fabs(sum);
}

static void lamp_corners(double half, pl_vec3 at, pl_vec3 corner[4]) {
  const double sign[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  for (int i = 0; i < 4; i++)
    corner[i] = pl_vec3_add(at, (pl_vec3){half * sign[i][0], half * sign[i][1], 0});
}

/* Compares, relative to the brightest, every pixel with 0.5/pi times the irradiance that `expect`
 * gives for its direction. */
typedef double (*expect_fn)(pl_vec3 direction);
static void check_image(const char *what, const film *f, const stage *s, expect_fn expect,
                        double pixel_tolerance, double mean_tolerance) {
  double worst = 0.0, brightest = 0.0, sum = 0.0, expected_sum = 0.0;
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++) {
      double expected = 0.0;
      for (int i = 0; i < 16; i++)
        expected += 0.5 / PL_PI / 16.0 *
                    expect(pl_camera_ray(&s->placement.camera, x + (i % 4 + 0.5) / 4.0 - 0.5,
                                         y + ((double)(i / 4) + 0.5) / 4.0 - 0.5));
      const double value = (double)f->radiance[3 * (y * SIDE + x)];
      worst = fmax(worst, fabs(value - expected));
      brightest = fmax(brightest, expected);
      sum += value;
      expected_sum += expected;
    }
  print_message("%s: worst pixel off by %.4f of the brightest, mean by %.5f\n", what,
                worst / brightest, sum / expected_sum - 1.0);
  assert_true(worst < pixel_tolerance * brightest);
  assert_true(fabs(sum / expected_sum - 1.0) < mean_tolerance);
}

/* --- a lamp over a plane ---------------------------------------------------------------------- */

static const pl_vec3 LAMP_AT = {0.5, -0.3, 8.0};
static const double GROUND_Z = 10.0;

static double lamp_on_ground(pl_vec3 direction) {
  const pl_vec3 point = pl_vec3_scale(direction, GROUND_Z / direction.z);
  pl_vec3 corner[4];
  lamp_corners(1.0, LAMP_AT, corner);
  return polygon_irradiance(corner, 4, point, (pl_vec3){0, 0, -1});
}

/* With emitters drawn alone (no bounces) and with both ways of meeting them. */
static void test_lamp_on_a_plane(void **state) {
  (void)state;
  pl_model *lamp = lamp_create(1.0), *ground = ground_create(40.0);
  stage s;
  dark_stage(&s, 20.0);
  stage_add_object(&s, lamp, LAMP_AT, PL_QUAT_IDENTITY, 1.0);
  stage_add_object(&s, ground, (pl_vec3){0, 0, GROUND_Z}, PL_QUAT_IDENTITY, 1.0);
  film drawn = shoot(&s, SAMPLES, 0, no_effects(), no_effects(), NULL),
       both = shoot(&s, SAMPLES, 1, all_effects(), no_effects(), NULL);
  check_image("lamp, drawn", &drawn, &s, lamp_on_ground, PIXEL_OFF, MEAN_OFF);
  check_image("lamp, drawn and met", &both, &s, lamp_on_ground, PIXEL_OFF, MEAN_OFF);
  film_clear(&drawn);
  film_clear(&both);
  stage_clear(&s);
  pl_model_destroy(lamp);
  pl_model_destroy(ground);
}

static void test_row_decides(void **state) {
  (void)state;
  pl_model *lamp = lamp_create(1.0), *ground = ground_create(40.0);
  stage s;
  pl_plan plan;
  dark_stage(&s, 20.0);
  stage_add_object(&s, ground, (pl_vec3){0, 0, GROUND_Z}, PL_QUAT_IDENTITY, 1.0);
  film f = shoot(&s, 4, 2, no_effects(), no_effects(), &plan);
  assert_int_equal(pl_plan_value(&plan, &pl_effect_emitters), 0);
  film_clear(&f);
  stage_add_object(&s, lamp, LAMP_AT, PL_QUAT_IDENTITY, 1.0);
  f = shoot(&s, 4, 2, no_effects(), no_effects(), &plan);
  assert_int_equal(pl_plan_value(&plan, &pl_effect_emitters), 1); /* no body to be lit */
  assert_true(mean_of(&f) > 0.0);
  film_clear(&f);
  f = shoot(&s, 4, 2, no_effects(), one_effect("emitters"), &plan);
  assert_int_equal(pl_plan_value(&plan, &pl_effect_emitters), 0);
  assert_true(mean_of(&f) == 0.0); /* nor is it met by chance */
  film_clear(&f);
  stage_clear(&s);
  pl_model_destroy(lamp);
  pl_model_destroy(ground);
}

static float glossy_roughness;

/* The lamp's light off a metal by quadrature over the lamp; times 2 pi, which check_image takes off
 * again. */
static double lamp_on_metal(pl_vec3 direction) {
  enum { STEPS = 24 };
  const pl_vec3 point = pl_vec3_scale(direction, GROUND_Z / direction.z);
  const pl_vec3 back = pl_vec3_unit(pl_vec3_scale(direction, -1.0));
  const pl_surface metal = {
      .color = {0.5f, 0.5f, 0.5f}, .metallic = 1.0f, .alpha = glossy_roughness * glossy_roughness};
  const pl_vec3f wo = {(float)back.x, (float)back.y, (float)-back.z};
  double sum = 0.0;
  for (int i = 0; i < STEPS * STEPS; i++) {
    const pl_vec3 at = {LAMP_AT.x + 2.0 * (i % STEPS + 0.5) / STEPS - 1.0,
                        LAMP_AT.y + 2.0 * ((double)(i / STEPS) + 0.5) / STEPS - 1.0, LAMP_AT.z};
    const pl_vec3 way = pl_vec3_sub(at, point), w = pl_vec3_unit(way);
    const pl_vec3f wi = {(float)w.x, (float)w.y, (float)-w.z};
    const double solid_angle = 4.0 / (STEPS * STEPS) * -w.z / pl_vec3_dot(way, way);
    sum += solid_angle * (double)pl_reflectance_metallic_roughness.evaluate(&metal, wo, wi).x;
  }
  return 2.0 * PL_PI * (double)RADIANCE * sum;
}

/* A glossy and a rough metal under the lamp, both ways of meeting it. */
static void test_lamp_on_metal(void **state) {
  (void)state;
  const float roughness[] = {0.3f, 0.8f};
  for (int i = 0; i < PL_DRAWS(2, 1); i++) {
    pl_model *lamp = lamp_create(1.0), *ground = square_create(40.0);
    stage s;
    glossy_roughness = ground->materials[0].roughness = roughness[i];
    ground->materials[0].metallic = 1.0f;
    dark_stage(&s, 20.0);
    stage_add_object(&s, lamp, LAMP_AT, PL_QUAT_IDENTITY, 1.0);
    stage_add_object(&s, ground, (pl_vec3){0, 0, GROUND_Z}, PL_QUAT_IDENTITY, 1.0);
    film both = shoot(&s, PL_DRAWS(4096, 256), 1, all_effects(), no_effects(), NULL);
    check_image(i == 0 ? "glossy metal" : "rough metal", &both, &s, lamp_on_metal,
                PL_DRAWS(0.06, 0.3), PL_DRAWS(4e-3, 0.06));
    film_clear(&both);
    stage_clear(&s);
    pl_model_destroy(lamp);
    pl_model_destroy(ground);
  }
}

/* --- bodies ----------------------------------------------------------------------------------- */

static const pl_vec3 GLOWING_AT = {0.0, -30.0, 20.0};
static const double GLOWING_RADIUS = 9.0;

/* A sphere of radiance L wholly above the horizon: pi L (r/d)^2 cos (Howell, B-38). */
static double sphere_on_ground(pl_vec3 direction) {
  const pl_vec3 point = pl_vec3_scale(direction, 30.0 / direction.z);
  const pl_vec3 way = pl_vec3_sub(GLOWING_AT, point);
  const double d = pl_vec3_norm(way), ratio = GLOWING_RADIUS / d;
  return PL_PI * (double)RADIANCE * ratio * ratio * (-way.z / d);
}

static void test_glowing_body(void **state) {
  (void)state;
  pl_model *ground = ground_create(100.0);
  stage s;
  dark_stage(&s, 60.0);
  stage_add_object(&s, ground, (pl_vec3){0, 0, 30.0}, PL_QUAT_IDENTITY, 1.0);
  const size_t body = stage_add_body(
      &s, GLOWING_AT, (pl_vec3){GLOWING_RADIUS, GLOWING_RADIUS, GLOWING_RADIUS}, 0.0f);
  for (int k = 0; k < 3; k++)
    s.bodies[body].emission[k] = RADIANCE;
  film drawn = shoot(&s, SAMPLES, 0, no_effects(), no_effects(), NULL),
       both = shoot(&s, SAMPLES, 1, all_effects(), no_effects(), NULL);
  check_image("glowing body, drawn", &drawn, &s, sphere_on_ground, PIXEL_OFF, MEAN_OFF);
  check_image("glowing body, drawn and met", &both, &s, sphere_on_ground, PIXEL_OFF, MEAN_OFF);
  film_clear(&drawn);
  film_clear(&both);
  stage_clear(&s);
  pl_model_destroy(ground);
}

static const double BODY_RADIUS = 100.0;

static double lamp_on_body(pl_vec3 direction) {
  const pl_vec3 center = {0, 0, GROUND_Z + BODY_RADIUS}, d = pl_vec3_unit(direction);
  const double b = pl_vec3_dot(center, d);
  const double t = b - sqrt(b * b - pl_vec3_dot(center, center) + BODY_RADIUS * BODY_RADIUS);
  const pl_vec3 point = pl_vec3_scale(d, t);
  pl_vec3 corner[4];
  lamp_corners(1.0, LAMP_AT, corner);
  return polygon_irradiance(corner, 4, point, pl_vec3_unit(pl_vec3_sub(point, center)));
}

static void test_lamp_on_a_body(void **state) {
  (void)state;
  pl_model *lamp = lamp_create(1.0);
  pl_plan plan;
  stage s;
  dark_stage(&s, 60.0);
  stage_add_object(&s, lamp, LAMP_AT, PL_QUAT_IDENTITY, 1.0);
  stage_add_body(&s, (pl_vec3){0, 0, GROUND_Z + BODY_RADIUS},
                 (pl_vec3){BODY_RADIUS, BODY_RADIUS, BODY_RADIUS}, 0.5f);
  film f = shoot(&s, SAMPLES, 1, no_effects(), no_effects(), &plan);
  assert_int_equal(pl_plan_value(&plan, &pl_effect_emitters), 2);
  check_image("lamp on a body", &f, &s, lamp_on_body, PIXEL_OFF, MEAN_OFF);
  film_clear(&f);
  stage_clear(&s);
  pl_model_destroy(lamp);
}

/* --- densities -------------------------------------------------------------------------------- */

/* Lamps of different size, power and distance, and a flattened body. */
static void many_emitters(stage *s, pl_model *models[2]) {
  dark_stage(s, 20.0);
  models[0] = lamp_create(1.0);
  models[1] = cube_create(0.5);
  models[1]->materials[0].emissive[0] = 900.0f;
  stage_add_object(s, models[0], LAMP_AT, PL_QUAT_IDENTITY, 0.5);
  stage_add_object(s, models[1], (pl_vec3){3, 1, 12}, PL_QUAT_IDENTITY, 0.5);
  const size_t body = stage_add_body(s, (pl_vec3){0, 20, 15}, (pl_vec3){5, 5, 3}, 0.1f);
  s->bodies[body].emission[1] = 8.0f;
}

/* What a draw says of its density is what a ray that meets the same point is told. */
static void test_density_of_draws(void **state) {
  (void)state;
  test_random random = {.seed = 31};
  stage s;
  pl_model *models[2];
  pl_arena arena;
  pl_snapshot shot;
  pl_emitters list;
  many_emitters(&s, models);
  pl_arena_init(&arena);
  assert_int_equal(pl_snapshot_build(&s.scene, &s.placement, &arena, &shot), PL_OK);
  assert_int_equal(pl_emitters_build(&shot, PL_DETAIL_FULL, &arena, &list), PL_OK);
  assert_int_equal(list.count, 3);
  pl_accelerators *kept;
  const pl_tracer *tracer;
  assert_int_equal(pl_accelerators_create(&kept), PL_OK);
  assert_int_equal(pl_geometry_tracer(kept, &shot, &arena, &tracer), PL_OK);
  int met[3] = {0}, drawn = 0;
  for (int i = 0; i < PL_DRAWS(20000, 5000); i++) {
    const pl_vec3 point = {random_range(&random, -2, 2), random_range(&random, -2, 2),
                           random_range(&random, 14, 18)};
    const float u[2] = {(float)(0.999999 * random_unit(&random)),
                        (float)(0.999999 * random_unit(&random))};
    pl_emitter_sample sample;
    if (!pl_emitters_sample(&list, point, u, &sample))
      continue;
    drawn++;
    assert_true(fabsf(pl_vec3f_norm(sample.direction) - 1.0f) < 1e-5f);
    assert_true(pl_luminance(sample.radiance) > 0.0f && sample.pdf > 0.0f);
    const pl_ray ray = {.origin = point,
                        .direction = pl_vec3f_to_double(sample.direction),
                        .t_max = INFINITY,
                        .skip_body = PL_NO_BODY};
    pl_hit hit;
    pl_tracer_closest(tracer, &ray, &hit, 1, false, true);
    if (pl_surface_is_none(hit.surface_id) || fabs(hit.t - sample.distance_m) > 2e-3 * hit.t)
      continue; /* grazed past, or something else is nearer */
    float cosine = 0.0f;
    const size_t slot = pl_shot_slot(&shot, hit.surface_id);
    if (slot == 0)
      cosine = fabsf(sample.direction.z);
    if (slot == 1) { /* a face of an upright cube */
      const pl_vec3f d = sample.direction;
      const pl_vec3f p = pl_vec3_to_float(pl_vec3_madd(ray.origin, hit.t, ray.direction));
      const float x = fabsf(p.x - 3.0f), y = fabsf(p.y - 1.0f), z = fabsf(p.z - 12.0f);
      cosine = x >= y && x >= z ? fabsf(d.x) : y >= z ? fabsf(d.y) : fabsf(d.z);
      if (x + y + z - fmaxf(x, fmaxf(y, z)) - fminf(x, fminf(y, z)) > 0.23f)
        continue; /* by an edge, where the hit may be on the face beside the one drawn */
    }
    if (slot == 1 && cosine < 0.05f)
      continue;
    const pl_emitter_hit at = {hit.surface_id, hit.triangle, hit.t, cosine};
    const float pdf = pl_emitters_pdf(&list, point, &at);
    if (fabsf(pdf - sample.pdf) > 5e-3f * pdf)
      fail_msg("surface %zu: drawn with %g, told %g", slot, (double)sample.pdf, (double)pdf);
    met[slot]++;
  }
  print_message("seed 31: %d draws, met %d %d %d\n", drawn, met[0], met[1], met[2]);
  assert_true(met[0] > PL_DRAWS(1000, 250) && met[1] > PL_DRAWS(50, 10) &&
              met[2] > PL_DRAWS(1000, 250));
  pl_accelerators_destroy(kept);
  pl_arena_clear(&arena);
  stage_clear(&s);
  pl_model_destroy(models[0]);
  pl_model_destroy(models[1]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_lamp_on_a_plane), cmocka_unit_test(test_row_decides),
      cmocka_unit_test(test_lamp_on_metal),   cmocka_unit_test(test_glowing_body),
      cmocka_unit_test(test_lamp_on_a_body),  cmocka_unit_test(test_density_of_draws),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
