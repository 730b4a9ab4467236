/* The promise of the row of clouds: frames by the plan differ from those with every effect on by no
 * more than the bounds of what was left out. */
#include "harness.h"

#include <stdio.h>

#include "airs.h"
#include "clouds.h"
#include "differences.h"

enum { SAMPLES = 8, SCENES = PL_DRAWS(12, 3) };

static const double AU = 149597870700.0;

/* A world with clouds in the view or behind the camera, near or far, perhaps with air, by a ground
 * that is less bright; perhaps an entity in space before it. */
static void build(stage *s, const pl_model *model, pl_air **air, test_random *random) {
  stage_init(s, WIDTH, HEIGHT, random_scale(random, 15.0, 60.0));
  s->placement.sun.position_m = pl_vec3_scale(random_direction(random), AU);
  const double radius = random_scale(random, 1e3, 1e7);
  const pl_air_settings settings = random_air(random, radius, 1e-3, 1.0);
  *air = air_create(&settings, radius);
  for (int i = 0; i < 2; i++) {
    pl_vec3 d = random_direction(random);
    d.z = i == 0 ? fabs(d.z) + random_unit(random) : -fabs(d.z);
    if (i == 1)
      d = (pl_vec3){-3.0 * d.x, -3.0 * d.y, d.z};
    const double gap = radius * random_scale(random, 1e-3, 30.0) + 30.0;
    const pl_vec3 place = pl_vec3_scale(pl_vec3_unit(d), radius + (i == 0 ? gap : 6.0 * radius));
    const size_t body = stage_add_body(s, place, (pl_vec3){radius, radius, 0.95 * radius},
                                       (float)random_range(random, 0.05, 0.9));
    s->bodies[body].clouds = random_clouds(random, radius);
    s->bodies[body].clouds.opacity *= (float)random_scale(random, 1e-6, 1.0);
    if (random_unit(random) < 0.5)
      s->scene.bodies[body].air = *air;
  }
  if (random_unit(random) < 0.5)
    stage_add_object(s, model, (pl_vec3){0, 0, 10}, random_rotation(random), 2.0);
}

/* Of the rows that were not forced to the same. */
static double allowance(const pl_plan *plan, const pl_effect_set *same, double tolerance_dn) {
  double sum = 3.0 * tolerance_dn; /* culling, for each entity */
  for (size_t i = 0; i < plan->count; i++)
    if (!pl_effect_set_has(same, i))
      sum += left_out_dn(&plan->rows[i]);
  return sum;
}

static int left_out, coarser;

static void compare(const stage *s, double tolerance_dn) {
  static statistic full, planned;
  pl_renderer *renderer;
  assert_int_equal(pl_renderer_create(&s->scene, &renderer), PL_OK);
  const pl_effect_set others = all_effects_but("clouds");
  asked asked = {SAMPLES, PL_FILTER_FINEST, {.force_on = all_effects()}};
  const pl_frame_result best = measure(s, renderer, asked, &full);
  asked.wish = (pl_plan_wish){.tolerance_dn = tolerance_dn, .force_on = others};
  const pl_frame_result result = measure(s, renderer, asked, &planned);
  const double allowed = allowance(&result.plan, &others, tolerance_dn);
  const double found = excess(&full, &planned, allowed);
  const int row = pl_effect_find("clouds");
  const pl_plan_row *chosen = &result.plan.rows[row];
  left_out += chosen->value == 0 && chosen->bound_dn > 0.0;
  coarser += chosen->value > 0 && chosen->value < best.plan.rows[row].value;
  pl_renderer_destroy(renderer);
  if (found > 0.0)
    fail_msg("tolerance %g, clouds %d: differs by %.3g DN, allowed %.3g", tolerance_dn,
             chosen->value, found, allowed);
}

static void test_promise(void **state) {
  (void)state;
  static const double tolerances[] = {0.5, 5.0, 25.0};
  test_random random = {.seed = 41};
  pl_model *model = cube_create(0.5);
  for (int round = 0; round < SCENES; round++) {
    stage s;
    pl_air *air;
    build(&s, model, &air, &random);
    compare(&s, tolerances[round % 3]);
    stage_clear(&s);
    pl_air_destroy(air);
  }
  pl_model_destroy(model);
  print_message("left out although it could matter %d times, coarser %d times\n", left_out,
                coarser);
  assert_true(PL_SEEN(left_out, 0) && PL_SEEN(coarser, 0));
}

/* The row says why it is off. */
static void test_absent(void **state) {
  (void)state;
  stage s;
  film f;
  pl_renderer *renderer;
  pl_frame_result result;
  stage_init(&s, WIDTH, HEIGHT, 30.0);
  stage_add_body(&s, (pl_vec3){0, 0, 3e6}, (pl_vec3){1e6, 1e6, 1e6}, 0.5f);
  film_init(&f, &s);
  pl_frame_request request = request_all(&s, &f);
  const int row = pl_effect_find("clouds");
  assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
  assert_int_equal(pl_renderer_plan(renderer, &request, &result), PL_OK);
  assert_string_equal(result.plan.rows[row].reason, "no body has clouds");
  s.bodies[0].clouds = overcast(1e4, 10.0f);
  assert_int_equal(pl_renderer_plan(renderer, &request, &result), PL_OK);
  assert_int_equal(result.plan.rows[row].value, 1);
  s.bodies[0].motion = still((pl_vec3){0, 0, -3e6}, PL_QUAT_IDENTITY);
  assert_int_equal(pl_renderer_plan(renderer, &request, &result), PL_OK);
  assert_int_equal(result.plan.rows[row].value, 0);
  assert_string_equal(result.plan.rows[row].reason,
                      "no clouds are visible, and none light or shadow anything in the frame");
  pl_renderer_destroy(renderer);
  film_clear(&f);
  stage_clear(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_absent),
      cmocka_unit_test(test_promise),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
