/* Paths against integrals: what is met after a bounce is seen as it is, neither rougher nor
 * blurred, at any tolerance. */
#include "harness.h"

#include "frames.h"
#include "shade/reflectance.h"
#include "surfaces.h"

enum { SIDE = 8, PIXELS = SIDE * SIDE, SAMPLES = PL_DRAWS(4096, 512) };
static const double OFF = PL_DRAWS(0.01, 0.05);

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

/* Mean radiance of the stage, which is cleared. */
static double shoot(stage *s, double tolerance_dn, int samples) {
  film f;
  pl_renderer *renderer;
  film_init(&f, s);
  pl_frame_request request = request_all(s, &f);
  request.samples = samples;
  request.max_bounces = 1;
  request.wish = (pl_plan_wish){.tolerance_dn = tolerance_dn,
                                .force_on = two_effects("antialiasing", "bounces"),
                                .force_off = one_effect("soft_sun")};
  assert_int_equal(pl_renderer_create(&s->scene, &renderer), PL_OK);
  render(renderer, &request);
  double sum = 0.0;
  for (size_t i = 0; i < PIXELS; i++)
    sum += (double)f.radiance[3 * i] / PIXELS;
  pl_renderer_destroy(renderer);
  film_clear(&f);
  stage_clear(s);
  return sum;
}

/* The metal wall z = 10, seen straight on; x = 1 is another, and both are wide. The sun is no wider
 * than a point. */
static double shoot_corner(double tolerance_dn, int samples) {
  stage s;
  stage_init(&s, SIDE, SIDE, 5000.0);
  s.placement.sun.position_m = pl_vec3_scale(SUN, AU);
  pl_model *seen = wall_create(SEEN), *beside = wall_create(BESIDE);
  const double half = 500.0;
  stage_add_object(&s, seen, (pl_vec3){1.0 - half, 0, 10},
                   pl_quat_axis_angle((pl_vec3){1, 0, 0}, PL_PI), half);
  stage_add_object(&s, beside, (pl_vec3){1, 0, 10.0 - half},
                   pl_quat_axis_angle((pl_vec3){0, 1, 0}, -0.5 * PL_PI), half);
  const double found = shoot(&s, tolerance_dn, samples);
  pl_model_destroy(seen);
  pl_model_destroy(beside);
  return found;
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
  enum { RINGS = PL_DRAWS(512, 128), SECTORS = 2 * RINGS };
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
  const double truth = integral();
  for (int i = 0; i < 2; i++) {
    const double found = shoot_corner(i, SAMPLES);
    print_message("tolerance %d: radiance %.3f, by quadrature %.3f W m-2 sr-1\n", i, found, truth);
    assert_true(fabs(found / truth - 1.0) < OFF);
  }
}

/* A wall behind the camera, |x| <= HALF, which shines where x is at least `edge`: by a picture,
 * whose texels are 2 HALF / TEXELS wide. */
enum { TEXELS = 512, EDGE = 10 };
static const double HALF = 128.0, BEHIND = 30.0;
static pl_model *picture_create(int edge) {
  pl_model *model = square_create(1.0);
  pl_image image;
  assert_int_equal(pl_image_init(TEXELS, 1, 1, &image), PL_OK);
  for (int i = 0; i < TEXELS; i++)
    image.texels[i] = i >= TEXELS / 2 + edge * TEXELS / (int)(2 * HALF) ? 255 : 0;
  model->uvs[0] = pl_alloc(2 * model->vertex_count, sizeof(float));
  model->textures = pl_alloc(1, sizeof *model->textures);
  assert_true(model->uvs[0] && model->textures);
  for (size_t v = 0; v < model->vertex_count; v++) {
    model->uvs[0][2 * v] = 0.5f + 0.5f * model->positions[3 * v];
    model->uvs[0][2 * v + 1] = 0.5f;
  }
  assert_int_equal(
      pl_texture_create(&image, false, PL_WRAP_CLAMP, PL_WRAP_CLAMP, &model->textures[0]), PL_OK);
  model->texture_count = 1;
  for (int k = 0; k < 3; k++) {
    model->materials[0].base_color[k] = 0.0f;
    model->materials[0].emissive[k] = 1.0f;
  }
  model->materials[0].emissive_map = (pl_texture_slot){.transform = PL_UV_IDENTITY};
  return model;
}

/* Seen in a small glossy wall straight ahead. */
static double shoot_picture(double tolerance_dn, int edge) {
  stage s;
  stage_init(&s, SIDE, SIDE, 5000.0);
  s.placement.sun.position_m = (pl_vec3){0.0, AU, 0.0}; /* lights neither */
  pl_model *seen = wall_create(SEEN), *picture = picture_create(edge);
  stage_add_object(&s, seen, (pl_vec3){0, 0, 10}, pl_quat_axis_angle((pl_vec3){1, 0, 0}, PL_PI),
                   0.01);
  stage_add_object(&s, picture, (pl_vec3){0, 0, 10.0 - BEHIND}, PL_QUAT_IDENTITY, HALF);
  const double found = shoot(&s, tolerance_dn, SAMPLES);
  pl_model_destroy(seen);
  pl_model_destroy(picture);
  return found;
}

/* The part of the light of a picture that shines all over, by the midpoint rule. */
static double part_beyond(int edge) {
  enum { STEPS = PL_DRAWS(1024, 256) };
  const pl_vec3f view = {0.0f, 0.0f, 1.0f};
  double all = 0.0, beyond = 0.0;
  for (int i = 0; i < STEPS; i++)
    for (int j = 0; j < STEPS; j++) {
      const double x = HALF * ((2 * i + 1.0) / STEPS - 1.0);
      const double y = HALF * ((2 * j + 1.0) / STEPS - 1.0);
      const double r2 = x * x + y * y + BEHIND * BEHIND, r = sqrt(r2);
      const pl_vec3f d = {(float)(x / r), (float)(y / r), (float)(BEHIND / r)};
      const double light = reflect(SEEN, view, d) * BEHIND / (r * r2); /* by area */
      all += light;
      beyond += x > edge ? light : 0.0;
    }
  return beyond / all;
}

static void test_a_picture_is_not_blurred(void **state) {
  (void)state;
  const double truth = part_beyond(EDGE);
  for (int i = 0; i < 2; i++) {
    const double found = shoot_picture(i, EDGE) / shoot_picture(i, -(int)HALF);
    print_message("tolerance %d: %.4f of the light, by quadrature %.4f\n", i, found, truth);
    assert_true(fabs(found / truth - 1.0) < OFF);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_metal_lights_metal),
      cmocka_unit_test(test_a_picture_is_not_blurred),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
