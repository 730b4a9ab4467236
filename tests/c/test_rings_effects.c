/* The promise of the row `rings`: frames by the plan differ from those with every effect on by no
 * more than the bounds of what was left out. */
#include "harness.h"

#include "plan/effects.h"
#include <stdio.h>

#include "differences.h"

enum { SAMPLES = 8, SCENES = PL_DRAWS(36, 6) };

static const double AU = 149597870700.0;

/* Even rings of any depth. */
static pl_rings *make_rings(test_random *random, double radius_m, double depth) {
  const double inner_m = radius_m * random_range(random, 1.05, 2.0);
  const double edges[2] = {inner_m, inner_m * random_range(random, 1.1, 2.5)};
  const double fraction = random_unit(random);
  const double albedo[3] = {random_unit(random), random_unit(random), random_unit(random)};
  pl_rings *rings;
  const pl_rings_settings settings = {.count = 1,
                                      .edges_m = edges,
                                      .depth = &depth,
                                      .albedo = albedo,
                                      .exponent = random_range(random, 0.0, 4.0),
                                      .dust_share = fraction,
                                      .dust_g = random_range(random, -0.5, 0.9)};
  assert_int_equal(pl_rings_create(&settings, &rings), PL_OK);
  return rings;
}

/* A world with rings, in the view or not, from near or far; a second one that they may shade or
 * hide, and perhaps an entity in space. */
static void build(stage *s, const pl_model *model, pl_rings **rings, test_random *random) {
  stage_init(s, WIDTH, HEIGHT, random_scale(random, 15.0, 60.0));
  s->placement.sun.position_m = pl_vec3_scale(random_direction(random), AU);
  const double radius = random_scale(random, 1e3, 1e8),
               gap = radius * random_scale(random, 0.1, 30.0);
  *rings = make_rings(random, radius, random_scale(random, 1e-7, 1.0));
  for (int i = 0; i < 2; i++) {
    pl_vec3 d = random_direction(random);
    d.z = random_unit(random) < 0.2 ? -fabs(d.z) : fabs(d.z) + random_range(random, 0.0, 1.5);
    const double size = i == 0 ? radius : radius * random_scale(random, 0.05, 0.5);
    const pl_vec3 place = pl_vec3_scale(pl_vec3_unit(d), size + gap * (1.0 + 0.7 * i) + 30.0);
    const size_t body = stage_add_body(s, place, (pl_vec3){size, size, 0.9 * size},
                                       (float)random_range(random, 0.05, 0.9));
    s->bodies[body].motion = still(place, random_rotation(random));
  }
  s->scene.bodies[0].rings = *rings;
  if (random_unit(random) < 0.5)
    stage_add_object(s, model, (pl_vec3){0, 0, 10}, random_rotation(random), 2.0);
}

static int dropped[64], kept;

static void describe(const stage *s, const pl_plan *plan) {
  for (size_t i = 0; i < plan->count; i++)
    print_message("  %-14s value %d, bound %.3g, residual %.3g\n", plan->rows[i].effect->name,
                  plan->rows[i].value, plan->rows[i].bound_dn, plan->rows[i].residual_dn);
  for (size_t i = 0; i < s->scene.body_count; i++)
    print_message("  body at %g %g %g, radius %g\n", s->bodies[i].motion.open.t.x,
                  s->bodies[i].motion.open.t.y, s->bodies[i].motion.open.t.z,
                  s->bodies[i].radii_m.x);
}

/* Of the rows that were not forced to the same. */
static double allowance(const pl_plan *plan, const pl_effect_set *same, double tolerance_dn) {
  double sum = 3.0 * tolerance_dn; /* culling, for each entity */
  for (size_t i = 0; i < plan->count; i++)
    if (!pl_effect_set_has(same, i))
      sum += left_out_dn(&plan->rows[i]);
  return sum;
}

static void compare(const stage *s, double tolerance_dn) {
  static statistic full, planned;
  pl_renderer *renderer;
  assert_int_equal(pl_renderer_create(&s->scene, &renderer), PL_OK);
  const pl_effect_set others = all_effects_but("rings");
  asked asked = {SAMPLES, PL_FILTER_FINEST, {.force_on = all_effects()}};
  measure(s, renderer, asked, &full);
  asked.wish = (pl_plan_wish){.tolerance_dn = tolerance_dn, .force_on = others};
  const pl_frame_result result = measure(s, renderer, asked, &planned);
  const double allowed = allowance(&result.plan, &others, tolerance_dn);
  const double found = excess(&full, &planned, allowed);
  for (size_t i = 0; i < result.plan.count; i++)
    dropped[i] += result.plan.rows[i].value == 0 && result.plan.rows[i].bound_dn > 0.0;
  kept += pl_plan_value(&result.plan, &pl_effect_rings) > 0;
  pl_renderer_destroy(renderer);
  if (found > 0.0) {
    describe(s, &result.plan);
    fail_msg("tolerance %g: differs by %.3g DN, allowed %.3g", tolerance_dn, found, allowed);
  }
}

static void test_promise(void **state) {
  (void)state;
  static const double tolerances[] = {0.5, 3.0, 15.0};
  test_random random = {.seed = 77};
  pl_model *model = cube_create(0.5);
  for (int round = 0; round < SCENES; round++) {
    stage s;
    pl_rings *rings;
    build(&s, model, &rings, &random);
    compare(&s, tolerances[round % 3]);
    stage_clear(&s);
    pl_rings_destroy(rings);
  }
  pl_model_destroy(model);
  print_message("rings were left out although they could matter %d times, and kept %d times\n",
                dropped[pl_effect_find("rings")], kept);
  assert_true(PL_SEEN(dropped[pl_effect_find("rings")], 2));
  assert_true(PL_SEEN(kept, 2));
}

/* Without rings the row is absent and says why; out of sight they cannot matter. */
static void test_absent(void **state) {
  (void)state;
  stage s;
  film f;
  pl_renderer *renderer;
  pl_frame_result result;
  test_random random = {.seed = 3};
  pl_rings *rings = make_rings(&random, 1e6, 1.0);
  stage_init(&s, WIDTH, HEIGHT, 30.0);
  stage_add_body(&s, (pl_vec3){0, 0, 2e7}, (pl_vec3){1e6, 1e6, 1e6}, 0.5f);
  film_init(&f, &s);
  pl_frame_request request = request_all(&s, &f);
  const int row = pl_effect_find("rings");
  assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
  assert_int_equal(pl_renderer_plan(renderer, &request, &result), PL_OK);
  assert_int_equal(result.plan.rows[row].value, 0);
  assert_string_equal(result.plan.rows[row].reason, "no body has rings");
  s.scene.bodies[0].rings = rings;
  assert_int_equal(pl_renderer_plan(renderer, &request, &result), PL_OK);
  assert_int_equal(result.plan.rows[row].value, 1);
  s.bodies[0].motion = still((pl_vec3){0, 0, -2e7}, PL_QUAT_IDENTITY);
  assert_int_equal(pl_renderer_plan(renderer, &request, &result), PL_OK);
  assert_int_equal(result.plan.rows[row].value, 0);
  assert_string_equal(result.plan.rows[row].reason,
                      "no rings are visible or cast shadows in the frame");
  pl_renderer_destroy(renderer);
  film_clear(&f);
  stage_clear(&s);
  pl_rings_destroy(rings);
}

/* Rings are seen where the body is not: they have edges, move, and may be out of focus. */
static void test_rings_alone(void **state) {
  (void)state;
  static const char *const rows[] = {"antialiasing", "motion_blur", "depth_of_field"};
  const double edges[2] = {1.5e6, 3e6}, depth = 1.0, albedo[3] = {0.9, 0.9, 0.9};
  const pl_rings_settings settings = {
      .count = 1, .edges_m = edges, .depth = &depth, .albedo = albedo, .exponent = 3.0};
  stage s;
  film f;
  pl_rings *rings;
  pl_renderer *renderer;
  pl_frame_result result;
  assert_int_equal(pl_rings_create(&settings, &rings), PL_OK);
  stage_init(&s, WIDTH, HEIGHT, 400.0);
  stage_add_body(&s, (pl_vec3){2.5e6, 0, 5e6}, (pl_vec3){1e6, 1e6, 1e6}, 0.5f);
  s.scene.bodies[0].rings = rings;
  s.placement.shutter.exposure_s = 1.0;
  s.placement.camera.motion.close.q = pl_quat_axis_angle((pl_vec3){1, 0, 0}, 0.01);
  s.placement.camera.aperture_m = 1.0;
  s.placement.camera.focus_per_m = 0.005;
  film_init(&f, &s);
  pl_frame_request request = request_all(&s, &f);
  request.samples = SAMPLES;
  request.exposure = (pl_exposure){.white_radiance = 100.0};
  assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
  assert_int_equal(pl_renderer_plan(renderer, &request, &result), PL_OK);
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    const pl_plan_row *row = &result.plan.rows[pl_effect_find(rows[i])];
    if (row->value == 0)
      fail_msg("%s is off: %s", rows[i], row->reason);
  }
  pl_renderer_destroy(renderer);
  film_clear(&f);
  stage_clear(&s);
  pl_rings_destroy(rings);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_absent),
      cmocka_unit_test(test_rings_alone),
      cmocka_unit_test(test_promise),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
