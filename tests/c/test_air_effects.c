/* The promise of the rows of the air: frames by the plan differ from those with every effect on by
 * no more than the bounds of what was left out. */
#include "harness.h"

#include <stdio.h>

#include "airs.h"
#include "differences.h"

enum { SAMPLES = 8, SCENES = PL_DRAWS(18, 2) };

static const double AU = 149597870700.0;

/* A world in the view, from its air or from far; perhaps a second one, and an entity in space. */
static void build(stage *s, const pl_model *model, pl_air *airs[2], test_random *random) {
  stage_init(s, WIDTH, HEIGHT, random_scale(random, 15.0, 60.0));
  s->placement.sun.position_m = pl_vec3_scale(random_direction(random), AU);
  const double radius = random_scale(random, 1e3, 1e7), thickest = random_scale(random, 1e-9, 1.0);
  for (int i = 0; i < 2; i++) {
    const pl_air_settings settings = random_air(random, radius, 0.1 * thickest, thickest);
    airs[i] = air_create(&settings, radius);
    const double gap = radius * random_scale(random, 1e-4, 10.0) + 30.0;
    pl_vec3 d = random_direction(random);
    d.z = fabs(d.z) + random_range(random, 0.0, 1.0);
    if (i == 1)
      d = (pl_vec3){-3.0 * d.x, -3.0 * d.y, d.z};
    const pl_vec3 place = pl_vec3_scale(pl_vec3_unit(d), radius + (i == 0 ? gap : 12.0 * radius));
    const size_t body = stage_add_body(s, place, (pl_vec3){radius, radius, 0.95 * radius},
                                       (float)random_range(random, 0.05, 0.9));
    s->scene.bodies[body].air = airs[i];
  }
  if (random_unit(random) < 0.5)
    stage_add_object(s, model, (pl_vec3){0, 0, 10}, random_rotation(random), 2.0);
}

static int dropped[64];

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
  pl_effect_set others = effects_without(all_effects(), two_effects("atmosphere", "skylight"));
  others = effects_without(others, one_effect("multiple_scattering"));
  asked asked = {SAMPLES, PL_FILTER_FINEST, {.force_on = all_effects()}};
  measure(s, renderer, asked, &full);
  asked.wish = (pl_plan_wish){.tolerance_dn = tolerance_dn, .force_on = others};
  const pl_frame_result result = measure(s, renderer, asked, &planned);
  const double allowed = allowance(&result.plan, &others, tolerance_dn);
  const double found = excess(&full, &planned, allowed);
  for (size_t i = 0; i < result.plan.count; i++)
    dropped[i] += result.plan.rows[i].value == 0 && result.plan.rows[i].bound_dn > 0.0;
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
    pl_air *airs[2];
    build(&s, model, airs, &random);
    compare(&s, tolerances[round % 3]);
    stage_clear(&s);
    pl_air_destroy(airs[0]);
    pl_air_destroy(airs[1]);
  }
  pl_model_destroy(model);
  static const char *const rows[] = {"atmosphere", "skylight", "multiple_scattering"};
  for (int i = 0; i < 3; i++)
    print_message("%s was left out although it could matter %d times\n", rows[i],
                  dropped[pl_effect_find(rows[i])]);
  assert_true(PL_SEEN(dropped[pl_effect_find("atmosphere")], 0));
}

/* Without air the rows are absent and say why; far from the frame it cannot matter. */
static void test_absent(void **state) {
  (void)state;
  stage s;
  film f;
  pl_renderer *renderer;
  pl_frame_result result;
  test_random random = {.seed = 3};
  const pl_air_settings settings = random_air(&random, 1e6, 0.1, 0.5);
  pl_air *air = air_create(&settings, 1e6);
  stage_init(&s, WIDTH, HEIGHT, 30.0);
  stage_add_body(&s, (pl_vec3){0, 0, 3e6}, (pl_vec3){1e6, 1e6, 1e6}, 0.5f);
  film_init(&f, &s);
  pl_frame_request request = request_all(&s, &f);
  const int row = pl_effect_find("atmosphere");
  assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
  assert_int_equal(pl_renderer_plan(renderer, &request, &result), PL_OK);
  assert_int_equal(result.plan.rows[row].value, 0);
  assert_string_equal(result.plan.rows[row].reason, "no body has an atmosphere");
  s.scene.bodies[0].air = air;
  assert_int_equal(pl_renderer_plan(renderer, &request, &result), PL_OK);
  assert_true(result.plan.rows[row].value > 4);
  assert_true(result.plan.rows[row].residual_dn <= request.wish.tolerance_dn);
  s.bodies[0].motion = still((pl_vec3){0, 0, -3e6}, PL_QUAT_IDENTITY);
  assert_int_equal(pl_renderer_plan(renderer, &request, &result), PL_OK);
  assert_int_equal(result.plan.rows[row].value, 0);
  assert_string_equal(result.plan.rows[row].reason,
                      "no atmosphere is visible, and none lights anything in the frame");
  pl_renderer_destroy(renderer);
  film_clear(&f);
  stage_clear(&s);
  pl_air_destroy(air);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_absent),
      cmocka_unit_test(test_promise),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
