/* The solver on effects made up here, and the geometry that bounds share. */
#include "harness.h"

#include <stdio.h>
#include <string.h>

#include "plan/effects.h"
#include "plan/plan.h"
#include "random.h"

/* The view's `samples` holds the ceiling, `white_radiance` the bound of leaving the effect out:
 * the bound falls as 1/(1 + value). */
static const char *never_absent(const pl_view *view) {
  (void)view;
  return NULL;
}
static const char *always_absent(const pl_view *view) {
  (void)view;
  return "nothing to see";
}
static int ceiling(const pl_view *view) { return view->samples; }
static double falling(const pl_view *view, int value) { return view->white_radiance / (1 + value); }
static double not_a_number(const pl_view *view, int value) {
  (void)view;
  (void)value;
  return NAN;
}
static double cost(const pl_view *view, int value) {
  (void)view;
  return 2.0 * value;
}

static const pl_effect counted = {"counted", "", never_absent, ceiling, falling, cost};
static const pl_effect other = {"other", "", never_absent, pl_effect_ceiling_one, falling, cost};
static const pl_effect missing = {"missing", "", always_absent, ceiling, falling, cost};
static const pl_effect broken = {"broken", "", never_absent, ceiling, not_a_number, cost};
static const pl_effect *const effects[] = {&counted, &other, &missing, &broken};

static pl_plan solve(double bound, int most, pl_plan_wish wish) {
  const pl_view view = {.samples = most, .white_radiance = bound};
  pl_plan plan;
  assert_int_equal(pl_plan_solve(effects, 4, &view, &wish, &plan), PL_OK);
  assert_int_equal(plan.count, 4);
  return plan;
}

static void test_smallest_value(void **state) {
  (void)state;
  for (int most = 1; most < 40; most++) {
    for (int k = 1; k < 60; k++) {
      const double bound = 0.37 * k, tolerance = 0.5;
      const pl_plan plan = solve(bound, most, (pl_plan_wish){.tolerance_dn = tolerance});
      int expected = 0; /* by trying every value */
      while (bound / (1 + expected) > tolerance && expected < most)
        expected++;
      assert_int_equal(plan.rows[0].value, expected);
      assert_int_equal(pl_plan_value(&plan, &counted), expected);
      assert_true(plan.rows[0].residual_dn == bound / (1 + expected));
      assert_true(plan.rows[0].bound_dn == bound);
      assert_true(plan.rows[0].cost_ms == 2.0 * expected);
      assert_true(strlen(plan.rows[0].reason) > 0);
    }
  }
}

/* Effects of one bound and one cost each, on or off. */
#define SWITCH(name, dn, ms)                                                                       \
  static double name##_bound(const pl_view *view, int value) {                                     \
    (void)view;                                                                                    \
    return value > 0 ? 0.0 : (dn);                                                                 \
  }                                                                                                \
  static double name##_cost(const pl_view *view, int value) {                                      \
    (void)view;                                                                                    \
    return (ms)*value;                                                                             \
  }                                                                                                \
  static const pl_effect name = {#name,        "",         never_absent, pl_effect_ceiling_one,    \
                                 name##_bound, name##_cost}
SWITCH(dear, 0.625, 1.0);
SWITCH(good, 0.5, 10.0);
SWITCH(poor, 0.25, 1.0);
SWITCH(best, 0.25, 50.0);
SWITCH(free_of_error, 0.0, 1e-3);
SWITCH(endless, INFINITY, 1e9);
static const pl_effect *const switches[] = {&dear, &good, &poor, &best, &free_of_error, &endless};

/* The tolerance is one for all: what saves most for its bound goes first, and sums stay within. */
static void test_tolerance_is_shared(void **state) {
  (void)state;
  const pl_view view = {.samples = 1};
  const struct {
    double tolerance, spent;
    int values[6];
  } cases[] = {{0.0, 0.0, {1, 1, 1, 1, 0, 1}},   {0.24, 0.0, {1, 1, 1, 1, 0, 1}},
               {0.25, 0.25, {1, 1, 1, 0, 0, 1}}, {0.5, 0.5, {1, 1, 0, 0, 0, 1}},
               {0.75, 0.75, {1, 0, 1, 0, 0, 1}}, {1.0, 1.0, {1, 0, 0, 0, 0, 1}},
               {1.5, 1.0, {1, 0, 0, 0, 0, 1}},   {1e9, 1.625, {0, 0, 0, 0, 0, 1}}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    pl_plan plan;
    const pl_plan_wish wish = {.tolerance_dn = cases[k].tolerance};
    assert_int_equal(pl_plan_solve(switches, 6, &view, &wish, &plan), PL_OK);
    double spent = 0.0;
    for (size_t i = 0; i < 6; i++) {
      assert_int_equal(plan.rows[i].value, cases[k].values[i]);
      assert_int_equal(plan.rows[i].ceiling, 1);
      assert_true(plan.rows[i].spent_dn == plan.rows[i].residual_dn);
      spent += plan.rows[i].spent_dn;
    }
    assert_true(spent == cases[k].spent);
  }
}

/* A row that is decided again has what the others left. */
static void test_deciding_again_shares_too(void **state) {
  (void)state;
  const pl_view view = {.samples = 1};
  const pl_plan_wish wish = {.tolerance_dn = 0.75};
  pl_plan plan;
  assert_int_equal(pl_plan_solve(switches, 6, &view, &wish, &plan), PL_OK);
  pl_plan_solve_again(&poor, &view, &wish, &plan);
  assert_int_equal(plan.rows[2].value, 1);
  assert_non_null(strstr(plan.rows[2].reason, "tolerance is 0.75, of which 0 is left"));
  plan.rows[1].spent_dn = 0.0; /* as if `good` had been kept */
  pl_plan_solve_again(&poor, &view, &wish, &plan);
  assert_int_equal(plan.rows[2].value, 0);
  assert_true(plan.rows[2].spent_dn == 0.25);
}

/* Errors that a ceiling leaves, and those that the user asks for, take nothing of the tolerance. */
static void test_what_takes_nothing(void **state) {
  (void)state;
  const pl_plan at_ceiling = solve(8.0, 3, (pl_plan_wish){.tolerance_dn = 1.0});
  assert_int_equal(at_ceiling.rows[0].value, 3);
  assert_true(at_ceiling.rows[0].residual_dn == 2.0 && at_ceiling.rows[0].spent_dn == 0.0);
  const pl_plan forced = solve(0.5, 8, (pl_plan_wish){.tolerance_dn = 1.0, .force_off = {{1}}});
  assert_true(forced.rows[0].residual_dn == 0.5 && forced.rows[0].spent_dn == 0.0);
  assert_int_equal(forced.rows[1].value, 0); /* the whole tolerance is left to it */
}

static void test_threshold_is_inclusive(void **state) {
  (void)state;
  assert_int_equal(solve(0.5, 8, (pl_plan_wish){.tolerance_dn = 0.5}).rows[0].value, 0);
  assert_int_equal(solve(nextafter(0.5, 1), 8, (pl_plan_wish){.tolerance_dn = 0.5}).rows[0].value,
                   1);
  /* Tolerance 0 keeps whatever changes anything. */
  assert_int_equal(solve(1e-300, 8, (pl_plan_wish){.tolerance_dn = 0.0}).rows[0].value, 8);
  assert_int_equal(solve(0.0, 8, (pl_plan_wish){.tolerance_dn = 0.0}).rows[0].value, 0);
}

static void test_forcing(void **state) {
  (void)state;
  const pl_plan on = solve(1e-9, 8, (pl_plan_wish){.tolerance_dn = 1.0, .force_on = {{0xf}}});
  for (size_t i = 0; i < 4; i++)
    assert_int_equal(on.rows[i].value, i == 1 ? 1 : 8);
  const pl_plan off = solve(1e9, 8, (pl_plan_wish){.tolerance_dn = 1.0, .force_off = {{0xf}}});
  for (size_t i = 0; i < 4; i++) {
    assert_int_equal(off.rows[i].value, 0);
    assert_true(off.rows[i].cost_ms == 0.0);
    assert_non_null(strstr(off.rows[i].reason, "force_off"));
  }
  assert_true(off.rows[0].residual_dn == 1e9); /* what was lost is said */
}

static void test_conflict(void **state) {
  (void)state;
  const pl_view view = {.samples = 4, .white_radiance = 1.0};
  const pl_plan_wish wish = {.tolerance_dn = 1.0, .force_on = {{2}}, .force_off = {{2}}};
  pl_plan plan;
  assert_int_equal(pl_plan_solve(effects, 4, &view, &wish, &plan), PL_E_ARGUMENT);
  assert_non_null(strstr(pl_error_text(), "other"));
  assert_int_equal(pl_plan_solve(effects, PL_PLAN_ROWS_MAX + 1, &view, &(pl_plan_wish){0}, &plan),
                   PL_E_ARGUMENT);
}

/* The table may grow beyond the bits of a word: every row of the largest table that a plan holds is
 * forced alone. */
static void test_rows_beyond_one_word(void **state) {
  (void)state;
  const pl_view view = {.samples = 8, .white_radiance = 0.25};
  const pl_effect *table[PL_PLAN_ROWS_MAX];
  assert_true(PL_PLAN_ROWS_MAX > PL_EFFECT_WORD);
  for (size_t i = 0; i < PL_PLAN_ROWS_MAX; i++)
    table[i] = &counted;
  for (size_t forced = 0; forced < PL_PLAN_ROWS_MAX; forced++) {
    pl_plan plan;
    pl_plan_wish wish = {.tolerance_dn = 0.25 * PL_PLAN_ROWS_MAX};
    pl_effect_set_add(&wish.force_on, forced);
    assert_int_equal(pl_plan_solve(table, PL_PLAN_ROWS_MAX, &view, &wish, &plan), PL_OK);
    for (size_t i = 0; i < PL_PLAN_ROWS_MAX; i++)
      assert_int_equal(plan.rows[i].value, i == forced ? 8 : 0);
  }
}

static void test_absent(void **state) {
  (void)state;
  const pl_plan plan = solve(1e9, 8, (pl_plan_wish){.tolerance_dn = 1.0});
  assert_int_equal(plan.rows[2].value, 0);
  assert_string_equal(plan.rows[2].reason, "nothing to see");
  assert_true(plan.rows[2].bound_dn == 0.0 && plan.rows[2].residual_dn == 0.0);
  static const pl_effect unlisted = {"counted", "", never_absent, ceiling, falling, cost};
  assert_int_equal(pl_plan_value(&plan, &unlisted), 0); /* its row counts, not its name */
}

static void test_undefined_bound_is_kept(void **state) {
  (void)state;
  assert_int_equal(solve(1.0, 8, (pl_plan_wish){.tolerance_dn = 1e9}).rows[3].value, 8);
}

/* The largest change of the display value over all levels that the light is added to. */
static void test_dn_is_an_upper_bound(void **state) {
  (void)state;
  const pl_view view = {.white_radiance = 137.0};
  for (int i = -8; i <= 2; i++) {
    const double step = 137.0 * pow(10.0, 0.5 * i), bound = pl_view_dn(&view, step);
    assert_true(bound >= 0.0 && bound <= 255.0);
    for (int k = 0; k <= 1000; k++) {
      const double base = 137.0 * k / 1000.0;
      assert_true(pl_view_dn(&view, base + step) - pl_view_dn(&view, base) <= bound + 1e-4);
    }
  }
  assert_true(pl_view_dn(&view, 0.0) == 0.0);
  assert_true(pl_view_dn(&view, 137.0) == 255.0);
  assert_true(pl_view_dn(&view, NAN) == 0.0);
}

static pl_view_entity sphere(pl_vec3 center, double radius) {
  return (pl_view_entity){.center_m = {center.x, center.y, center.z}, .radius_m = radius};
}

/* Whether the segment from p to s passes the sphere. */
static bool blocked(pl_vec3 p, pl_vec3 s, pl_vec3 center, double radius) {
  const pl_vec3 d = pl_vec3_sub(s, p), f = pl_vec3_sub(center, p);
  const double along = fmin(fmax(pl_vec3_dot(f, d) / pl_vec3_dot(d, d), 0.0), 1.0);
  return pl_vec3_norm(pl_vec3_madd(f, -along, d)) < radius;
}

/* Points of a receiver from which a point of the sun is hidden: the shadow must be seen to reach.
 * From a point cast to the far side of the solar system. */
static void test_shadow_reaches_never_misses(void **state) {
  (void)state;
  test_random random = {.seed = 11};
  int found = 0, claimed = 0;
  print_message("seed 11\n");
  for (int i = 0; i < 4000; i++) {
    const double sun_distance = random_scale(&random, 2e10, 5e12), sun_radius = 695700e3;
    const pl_vec3 sun = pl_vec3_scale(random_direction(&random), sun_distance);
    const double size = random_scale(&random, 1.0, 1e8);
    const pl_vec3 caster = pl_vec3_scale(random_direction(&random), random_scale(&random, 1, 3e9));
    const pl_vec3 away = pl_vec3_unit(pl_vec3_sub(caster, sun));
    const double reach = size * random_scale(&random, 0.5, 300.0);
    const double receiver_size = size * random_scale(&random, 1e-3, 3.0);
    const pl_vec3 receiver =
        pl_vec3_madd(pl_vec3_madd(caster, reach, away), size * random_range(&random, 0.0, 4.0),
                     random_direction(&random));
    const pl_view view = {.sun_radius_rad = asin(sun_radius / sun_distance),
                          .sun_radius_m = sun_radius,
                          .sun_position_m = {sun.x, sun.y, sun.z}};
    const pl_view_entity from = sphere(caster, size), to = sphere(receiver, receiver_size);
    const bool reaches = pl_view_shadow_reaches(&view, &from, &to);
    bool hidden = false;
    for (int k = 0; k < 200 && !hidden; k++) {
      const pl_vec3 p = pl_vec3_madd(receiver, receiver_size, random_direction(&random));
      const pl_vec3 s = pl_vec3_madd(sun, sun_radius, random_direction(&random));
      hidden = blocked(p, s, caster, size);
    }
    found += hidden;
    claimed += reaches;
    if (hidden)
      assert_true(reaches);
  }
  assert_true(found > 500);
  assert_true(claimed < 3500); /* and it is no constant */
  print_message("hidden in %d, claimed in %d of 4000\n", found, claimed);
}

static void test_shadow_of_a_far_moon(void **state) {
  (void)state;
  /* The camera at the origin beside Callisto, a moon 1.88e9 m away eclipsed by a planet: the sun's
   * direction there differs by 0.14 deg from the camera's, three times the sun's radius. */
  const double distance = 7.8e11;
  const pl_view view = {.sun_radius_rad = asin(695700e3 / distance),
                        .sun_radius_m = 695700e3,
                        .sun_position_m = {distance, 0, 0}};
  const pl_vec3 caster = {0, 1.88e9, 0};
  const pl_vec3 away = pl_vec3_unit(pl_vec3_sub(caster, (pl_vec3){distance, 0, 0}));
  const pl_view_entity planet = sphere(caster, 1e6);
  const pl_view_entity behind = sphere(pl_vec3_madd(caster, 1e9, away), 1e3);
  const pl_view_entity before = sphere(pl_vec3_madd(caster, -1e9, away), 1e3);
  assert_true(pl_view_shadow_reaches(&view, &planet, &behind));
  assert_false(pl_view_shadow_reaches(&view, &planet, &before));
}

/* The exact fraction of the sky of a plate facing a sphere is (radius/distance)^2. */
static void test_view_factor(void **state) {
  (void)state;
  const pl_view_entity source = sphere((pl_vec3){0, 0, 0}, 2.0);
  for (double d = 2.5; d < 1e6; d *= 1.7) {
    const pl_view_entity plate = sphere((pl_vec3){d + 0.3, 0, 0}, 0.3);
    const double exact = 4.0 / (d * d); /* of the nearest point */
    assert_true(pl_view_factor(&plate, &source) >= exact * (1 - 1e-12));
    assert_true(pl_view_factor(&plate, &source) <= fmin(1.0, 1.01 * exact));
  }
  const pl_view_entity touching = sphere((pl_vec3){2.1, 0, 0}, 0.3);
  assert_true(pl_view_factor(&touching, &source) == 1.0);
}

/* Two bodies with terrain: the plan keeps as many levels as those need that are brighter than the
 * tolerance, and the bound of fewer is the light of the others. */
static void test_levels_of_terrain(void **state) {
  (void)state;
  const pl_effect *row[] = {&pl_effect_terrain};
  pl_view_entity entities[2];
  for (int k = 0; k < 2; k++) {
    entities[k] = sphere((pl_vec3){0.0, k ? 1e9 : -1e9, 1e9}, 1e3);
    entities[k].in_frame = entities[k].diffuse = true;
    entities[k].ggx_alpha_min = 1.0;
    entities[k].irradiance = 100.0;
    entities[k].terrain = k ? 12 : 25;
    entities[k].albedo_max = k ? 0.5 : 1e-4;
  }
  pl_view view = {.white_radiance = 20.0, .entities = entities, .entity_count = 2};
  const pl_plan_wish wishes[] = {
      {.tolerance_dn = 0.0}, {.tolerance_dn = 1.0}, {.tolerance_dn = 255.0}};
  const int values[] = {25, 12, 0};
  for (int k = 0; k < 3; k++) {
    pl_plan plan;
    assert_int_equal(pl_plan_solve(row, 1, &view, &wishes[k], &plan), PL_OK);
    assert_int_equal(pl_plan_value(&plan, &pl_effect_terrain), values[k]);
    assert_true(plan.rows[0].residual_dn <= wishes[k].tolerance_dn);
    assert_true(k != 1 || plan.rows[0].residual_dn > 0.0);
  }
  for (int value = 0; value < 25; value++) /* bounds fall with the levels, to 0 at the last */
    assert_true(pl_effect_terrain.bound_dn(&view, value) >=
                pl_effect_terrain.bound_dn(&view, value + 1));
  assert_true(pl_effect_terrain.bound_dn(&view, 25) == 0.0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_smallest_value),
      cmocka_unit_test(test_tolerance_is_shared),
      cmocka_unit_test(test_deciding_again_shares_too),
      cmocka_unit_test(test_what_takes_nothing),
      cmocka_unit_test(test_threshold_is_inclusive),
      cmocka_unit_test(test_forcing),
      cmocka_unit_test(test_conflict),
      cmocka_unit_test(test_rows_beyond_one_word),
      cmocka_unit_test(test_absent),
      cmocka_unit_test(test_undefined_bound_is_kept),
      cmocka_unit_test(test_dn_is_an_upper_bound),
      cmocka_unit_test(test_shadow_reaches_never_misses),
      cmocka_unit_test(test_shadow_of_a_far_moon),
      cmocka_unit_test(test_view_factor),
      cmocka_unit_test(test_levels_of_terrain),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
