/* The plan's promise: a frame rendered by the plan differs from one with every effect on by no more
 * than the bounds of what the plan left out. Random small scenes, several seeds of each frame. */
#include "harness.h"

#include <stdio.h>

#include "differences.h"

enum { SAMPLES = 64, SCENES = PL_DRAWS(40, 12) };

static const double AU = 149597870700.0;

static void paint(pl_model *model, test_random *random) {
  pl_material *m = &model->materials[0];
  for (int k = 0; k < 3; k++)
    m->base_color[k] = (float)random_range(random, 0.05, 0.9);
  m->lambert = random_unit(random) < 0.6; /* Lambert */
  m->roughness = (float)random_range(random, 0.2, 1.0);
  m->metallic = (float)random_unit(random);
  if (random_unit(random) < 0.2)
    m->emissive[0] = (float)random_range(random, 0.0, 200.0);
  m->layered = random_unit(random) < 0.5;
  m->layers = PL_MATERIAL_LAYERS_PLAIN;
  m->layers.coat = (float)fmax(0.0, random_range(random, -0.5, 1.0));
  m->layers.coat_roughness = (float)random_range(random, 0.2, 1.0);
  m->layers.transmission = (float)fmax(0.0, random_range(random, -0.5, 1.0));
}

/* A map of random texels. */
static pl_texture *speckle(test_random *random) {
  pl_image image;
  pl_texture *texture;
  assert_int_equal(pl_image_init(8, 4, 3, &image), PL_OK);
  for (int i = 0; i < 8 * 4 * 3; i++)
    image.texels[i] = (uint8_t)random_below(random, 256);
  assert_int_equal(pl_texture_create(&image, true, PL_WRAP_REPEAT, PL_WRAP_CLAMP, &texture), PL_OK);
  return texture;
}

/* Relief, water and lights on some of the bodies; by draws of its own. */
static void break_ground(stage *s, const pl_texture *map, test_random *random) {
  for (size_t i = 0; i < s->scene.body_count; i++) {
    pl_ground *ground = &s->scene.bodies[i].ground;
    pl_ground_state *state = &s->bodies[i].ground;
    if (random_unit(random) < 0.3) {
      *(random_unit(random) < 0.5 ? &ground->heights : &ground->normals) = map;
      ground->north = 1.0f;
      state->height_m = (float)(s->bodies[i].radii_m.x * random_scale(random, 1e-3, 0.1));
      state->steepness = (float)random_scale(random, 1e-3, 1.0);
    }
    if (random_unit(random) < 0.3) {
      ground->ocean = true;
      ground->water = random_unit(random) < 0.5 ? map : NULL;
      state->wind_m_s = (float)random_range(random, 0.0, 20.0);
    }
    if (random_unit(random) < 0.3) {
      ground->lights = map;
      state->lights[0] = (float)random_scale(random, 1e-4, 100.0);
    }
  }
}

/* Half of the scenes are of bodies alone: there the plan has most to leave out. */
static void build(stage *s, pl_model **models, const pl_texture *map, test_random *random) {
  stage_init(s, WIDTH, HEIGHT, random_scale(random, 15.0, 60.0));
  s->placement.sun.position_m =
      pl_vec3_scale(random_direction(random), AU * random_scale(random, 0.3, 5.0));
  const int objects = random_unit(random) < 0.5 ? 0 : 1 + random_below(random, 3);
  for (int i = 0; i < objects; i++) {
    const pl_vec3 d = random_direction(random);
    const double reach = random_scale(random, 1.0, 30.0);
    stage_add_object(s, models[random_below(random, 3)],
                     (pl_vec3){reach * d.x, reach * d.y, 12.0 + reach * d.z},
                     random_rotation(random), random_scale(random, 0.5, 4.0));
  }
  const int bodies = objects > 0 ? random_below(random, 3) : 1 + random_below(random, 3);
  for (int i = 0; i < bodies; i++) {
    const double radius = random_scale(random, 1.0, 1e5);
    const double gap = radius * random_scale(random, 0.05, 30.0) + 20.0;
    const pl_vec3 d = pl_vec3_unit(
        pl_vec3_add(random_direction(random), (pl_vec3){0, 0, random_range(random, 0, 2)}));
    const size_t body =
        stage_add_body(s, pl_vec3_scale(d, radius + gap), (pl_vec3){radius, radius, 0.8 * radius},
                       (float)random_range(random, 0.05, 1.0));
    if (random_unit(random) < 0.4)
      s->scene.bodies[body].map = map;
    if (random_unit(random) < 0.2)
      s->bodies[body].emission[1] = (float)random_range(random, 0.0, 100.0);
  }
}

/* Whether two bodies overlap or one holds the camera: no scene. */
static bool sound(const stage *s) {
  for (size_t i = 0; i < s->scene.body_count; i++)
    for (size_t k = 0; k < i; k++)
      if (pl_vec3_norm(pl_vec3_sub(s->bodies[i].motion.open.t, s->bodies[k].motion.open.t)) <
          s->bodies[i].radii_m.x + s->bodies[k].radii_m.x)
        return false;
  return true;
}

/* What the plan says it left out, and what culling may leave out at the tolerance. */
static double allowance(const pl_plan *plan, const stage *s, double tolerance_dn) {
  double sum = tolerance_dn * (double)(s->scene.object_count + s->scene.body_count);
  for (size_t i = 0; i < plan->count; i++)
    if (strcmp(plan->rows[i].effect->name, "antialiasing") != 0) /* forced to the same in both */
      sum += left_out_dn(&plan->rows[i]);
  return sum;
}

static void describe(const stage *s, const pl_plan *plan) {
  for (size_t i = 0; i < plan->count; i++)
    print_message("  %-14s value %d, bound %.3g, residual %.3g: %s\n", plan->rows[i].effect->name,
                  plan->rows[i].value, plan->rows[i].bound_dn, plan->rows[i].residual_dn,
                  plan->rows[i].reason);
  for (size_t i = 0; i < s->scene.object_count; i++)
    print_message("  object at %g %g %g, scale %g\n", s->objects[i].motion.open.t.x,
                  s->objects[i].motion.open.t.y, s->objects[i].motion.open.t.z,
                  s->objects[i].scale);
  for (size_t i = 0; i < s->scene.body_count; i++)
    print_message("  body at %g %g %g, radius %g, albedo %g\n", s->bodies[i].motion.open.t.x,
                  s->bodies[i].motion.open.t.y, s->bodies[i].motion.open.t.z,
                  s->bodies[i].radii_m.x, (double)s->bodies[i].albedo[0]);
}

static int dropped[PL_PLAN_ROWS_MAX];

static void compare(const stage *s, double tolerance_dn) {
  static statistic full, planned;
  pl_renderer *renderer;
  assert_int_equal(pl_renderer_create(&s->scene, &renderer), PL_OK);
  asked asked = {SAMPLES, PL_FILTER_FINEST, {.force_on = all_effects()}};
  measure(s, renderer, asked, &full);
  asked.wish = (pl_plan_wish){.tolerance_dn = tolerance_dn, .force_on = one_effect("antialiasing")};
  const pl_frame_result result = measure(s, renderer, asked, &planned);
  const double allowed = allowance(&result.plan, s, tolerance_dn);
  const double found = excess(&full, &planned, allowed);
  for (size_t i = 0; i < result.plan.count; i++)
    dropped[i] += result.plan.rows[i].value == 0 && result.plan.rows[i].bound_dn > 0.0;
  pl_renderer_destroy(renderer);
  if (found > 0.0) {
    describe(s, &result.plan);
    fail_msg("tolerance %g: differs by %.3g DN, allowed %.3g", tolerance_dn, found, allowed);
  }
}

static void test_plan_keeps_its_promise(void **state) {
  (void)state;
  static const double tolerances[] = {0.5, 2.0, 10.0};
  test_random random = {.seed = 95}, grounds = {.seed = 96};
  print_message("seed %d\n", (int)random.seed);
  for (int round = 0; round < SCENES; round++) {
    pl_model *models[3] = {cube_create(0.5), square_create(1.0), soup_create(&random, 12)};
    stage s;
    for (int i = 0; i < 3; i++)
      paint(models[i], &random);
    pl_texture *map = speckle(&random);
    build(&s, models, map, &random);
    break_ground(&s, map, &grounds);
    if (sound(&s))
      compare(&s, tolerances[round % 3]);
    stage_clear(&s);
    pl_texture_destroy(map);
    for (int i = 0; i < 3; i++)
      pl_model_destroy(models[i]);
  }
  for (size_t i = 0; i < pl_effect_count; i++)
    print_message("%s was left out although it could matter %d times\n", pl_effects[i]->name,
                  dropped[i]);
  assert_true(PL_SEEN(dropped[pl_effect_find("soft_sun")], 0));
  assert_true(PL_SEEN(dropped[pl_effect_find("body_bounces")], 0));
  assert_true(PL_SEEN(dropped[pl_effect_find("bounces")], 0));
  assert_true(PL_SEEN(dropped[pl_effect_find("surface_maps")], 0));
  assert_true(PL_SEEN(dropped[pl_effect_find("night_lights")], 0));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_plan_keeps_its_promise),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
