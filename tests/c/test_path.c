/* Paths against integrals: light that metal hands on to metal, at a tolerance of nothing, is that
 * of the surfaces as they are. */
#include "harness.h"

#include "frames.h"
#include "shade/reflectance.h"
#include "surfaces.h"

enum { SIDE = 8, PIXELS = SIDE * SIDE };

/* To the sun, and roughness and reflectance of the wall that is seen and of the one beside it. */
static const pl_vec3 SUN = {-0.6, 0.0, -0.8};
static const double IRRADIANCE = 1361.0, AU = 149597870700.0;
static const float SEEN = 0.55f, BESIDE = 0.3f, COLOR = 0.9f;

static pl_model *wall_create(float roughness) {
  pl_model *model = square_create(1.0);
  for (int k = 0; k < 3; k++)
    model->materials[0].base_color[k] = COLOR;
  model->materials[0].metallic = 1.0f;
  model->materials[0].roughness = roughness;
  return model;
}

/* Mean radiance of the metal wall z = 10, seen straight on; x = 1 is another, and both are wide.
 * The sun is no wider than a point. */
static double shoot(double tolerance_dn, int samples) {
  stage s;
  film f;
  pl_renderer *renderer;
  stage_init(&s, SIDE, SIDE, 5000.0);
  s.placement.sun.position_m = pl_vec3_scale(SUN, AU);
  pl_model *seen = wall_create(SEEN), *beside = wall_create(BESIDE);
  const double half = 500.0;
  stage_add_object(&s, seen, (pl_vec3){1.0 - half, 0, 10},
                   pl_quat_axis_angle((pl_vec3){1, 0, 0}, PL_PI), half);
  stage_add_object(&s, beside, (pl_vec3){1, 0, 10.0 - half},
                   pl_quat_axis_angle((pl_vec3){0, 1, 0}, -0.5 * PL_PI), half);
  film_init(&f, &s);
  pl_frame_request request = request_all(&s, &f);
  request.samples = samples;
  request.max_bounces = 1;
  request.wish = (pl_plan_wish){.tolerance_dn = tolerance_dn,
                                .force_on = effect_bit("antialiasing") | effect_bit("bounces"),
                                .force_off = effect_bit("soft_sun")};
  assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
  render(renderer, &request);
  double sum = 0.0;
  for (size_t i = 0; i < PIXELS; i++)
    sum += (double)f.radiance[3 * i] / PIXELS;
  pl_renderer_destroy(renderer);
  film_clear(&f);
  stage_clear(&s);
  pl_model_destroy(seen);
  pl_model_destroy(beside);
  return sum;
}

static double reflect(float roughness, pl_vec3f wo, pl_vec3f wi) {
  pl_surface s = white(roughness * roughness, 1.0f);
  s.color = (pl_vec3f){COLOR, COLOR, COLOR};
  return wi.z > 0.0f && wo.z > 0.0f
             ? (double)pl_reflectance_metallic_roughness.evaluate(&s, wo, wi).x
             : 0.0;
}

/* The same by the midpoint rule over the directions from a point of the wall. Its axes here: x to
 * the other wall, z to the camera; those of the other: z away from it, x to the camera. */
static double integral(void) {
  enum { RINGS = 512, SECTORS = 1024 };
  const pl_vec3f view = {0.0f, 0.0f, 1.0f};
  const pl_vec3f sun = {(float)SUN.x, 0.0f, (float)-SUN.z}, sun_beside = {sun.z, 0.0f, -sun.x};
  double sum = reflect(SEEN, view, sun);
  for (int i = 0; i < RINGS; i++)
    for (int j = 0; j < SECTORS; j++) {
      const double z = (i + 0.5) / RINGS, r = sqrt(1.0 - z * z),
                   phi = (2.0 * PL_PI) * (j + 0.5) / SECTORS;
      const pl_vec3f d = {(float)(r * cos(phi)), (float)(r * sin(phi)), (float)z};
      const pl_vec3f back = {-d.z, d.y, d.x}; /* of -d, by its own axes, whose y is turned about */
      if (d.x > 0.0f)
        sum += reflect(SEEN, view, d) * reflect(BESIDE, back, sun_beside) * (2.0 * PL_PI) /
               ((double)RINGS * SECTORS);
    }
  return sum * IRRADIANCE;
}

static void test_metal_lights_metal(void **state) {
  (void)state;
  const double truth = integral(), found = shoot(0.0, 4096);
  print_message("radiance %.3f, by quadrature %.3f W m-2 sr-1\n", found, truth);
  assert_true(fabs(found / truth - 1.0) < 0.01);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_metal_lights_metal),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
