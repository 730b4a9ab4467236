/* The tree over the entities of a view: its answers against all pairs, and the work that they take.
 */
#include "harness.h"

#include "base/memory.h"
#include "frame/effects.h"
#include "plan/plan.h"
#include "plan/view_tree.h"
#include "random.h"

enum { MOST = 4096 };
static const double AU = 149597870700.0;

/* Spacecraft at random in a cube whose side grows with their number, and every tenth entity a body
 * that is larger. */
static pl_view many_entities(test_random *random, pl_view_entity *entities, size_t count) {
  const double side = 40.0 * cbrt((double)count);
  for (size_t i = 0; i < count; i++) {
    entities[i] = (pl_view_entity){.is_body = i % 10 == 9,
                                   .in_frame = i % 3 == 0,
                                   .radius_m = random_scale(random, 0.5, i % 10 == 9 ? 20.0 : 4.0),
                                   .albedo_max = random_range(random, 0.1, 1.0),
                                   .ggx_alpha_min = random_range(random, 0.2, 1.0),
                                   .irradiance = 1361.0};
    entities[i].is_world = entities[i].is_body;
    for (int k = 0; k < 3; k++)
      entities[i].center_m[k] = random_range(random, -side, side);
  }
  return (pl_view){.white_radiance = 400.0,
                   .sun_position_m = {AU, 0.3 * AU, 0.1 * AU},
                   .sun_radius_m = 695700e3,
                   .max_bounces = 2,
                   .entities = entities,
                   .entity_count = count};
}

static double light_of(const pl_view_entity *source, const void *context) {
  *(size_t *)(uintptr_t)context += 1;
  return pl_view_light(source);
}

/* Never below the sum over all pairs, and above it by half in the mean at most. */
static void test_sums_are_bounds(void **state) {
  (void)state;
  static pl_view_entity entities[MOST];
  test_random random = {.seed = 61};
  pl_arena arena;
  pl_arena_init(&arena);
  print_message("seed 61\n");
  for (size_t count = PL_VIEW_FEW + 1; count <= 1600; count *= 2) {
    pl_view view = many_entities(&random, entities, count), pairs = view;
    size_t calls = 0;
    double over = 0.0;
    assert_int_equal(pl_view_tree_build(&arena, &view), PL_OK);
    assert_non_null(view.tree);
    pl_view_weigh(&view, light_of, &calls);
    for (size_t i = 0; i < count; i++) {
      const double exact = pl_view_sum(&pairs, &entities[i], light_of, &calls);
      const double bound = pl_view_sum(&view, &entities[i], light_of, &calls);
      assert_true(bound >= exact * (1.0 - 1e-12));
      const double all = pl_view_sum_light(&pairs, &entities[i]);
      const double light = pl_view_sum_light(&view, &entities[i]);
      assert_true(light >= all * (1.0 - 1e-12) && light < 3.0 * all);
      over += bound / exact / (double)count;
    }
    print_message("%zu things: %.3f of the sum\n", count, over);
    assert_true(over < 1.5);
  }
  pl_arena_clear(&arena);
}

/* What shadows can fall on does not depend on the tree. */
static void test_shadows_are_the_same(void **state) {
  (void)state;
  static pl_view_entity entities[MOST];
  test_random random = {.seed = 62};
  pl_arena arena;
  size_t shadowed = 0, bodies = 0;
  pl_arena_init(&arena);
  for (int round = 0; round < 20; round++) {
    pl_view view = many_entities(&random, entities, 300), pairs = view;
    assert_int_equal(pl_view_tree_build(&arena, &view), PL_OK);
    for (size_t i = 9; i < view.entity_count; i += 10, bodies++) {
      assert_int_equal(pl_view_shadowed(&view, i), pl_view_shadowed(&pairs, i));
      shadowed += pl_view_shadowed(&view, i);
    }
  }
  print_message("seed 62: %zu of %zu bodies in shadow\n", shadowed, bodies);
  assert_true(shadowed > bodies / 20 && shadowed < bodies - bodies / 20);
  pl_arena_clear(&arena);
}

typedef struct counter {
  const pl_view *view;
  const pl_view_entity *receiver;
  size_t asked;
} counter;

static bool shades(const pl_view_entity *caster, bool several, void *context) {
  counter *c = context;
  c->asked++;
  return several ? pl_view_shadow_reaches(c->view, caster, c->receiver) : false;
}

/* Work for all entities, in sources looked at and in shadows asked for. A line to the sun passes as
 * many entities as the cube's side is long in them: 16 times as many entities take 16^(4/3) = 40
 * times as much, not 256 times. */
static void test_work_grows_with_the_number(void **state) {
  (void)state;
  static pl_view_entity entities[MOST];
  test_random random = {.seed = 63};
  size_t sources[2] = {0, 0}, shadows[2] = {0, 0};
  pl_arena arena;
  pl_arena_init(&arena);
  for (int k = 0; k < 2; k++) {
    pl_view view = many_entities(&random, entities, k == 0 ? 256 : MOST);
    assert_int_equal(pl_view_tree_build(&arena, &view), PL_OK);
    pl_view_weigh(&view, light_of, &sources[k]);
    for (size_t i = 0; i < view.entity_count; i++) {
      counter c = {&view, &entities[i], 0};
      pl_view_sum(&view, &entities[i], light_of, &sources[k]);
      pl_view_any(&view, shades, &c);
      shadows[k] += c.asked;
    }
  }
  print_message("256 and %d things: %zu and %zu sources, %zu and %zu shadows\n", (int)MOST,
                sources[0], sources[1], shadows[0], shadows[1]);
  assert_true(sources[1] < 40 * sources[0]);
  assert_true(shadows[1] < 50 * shadows[0]);
  pl_arena_clear(&arena);
}

/* Moons in a shell about a planet, which lights them all. */
static void place_moons(test_random *random, pl_view_entity *entities, size_t count) {
  for (size_t i = 0; i < count; i++) {
    double square = 0.0;
    entities[i].is_body = entities[i].is_world = true;
    entities[i].radius_m = i == count / 2 ? 6.4e6 : 1e5;
    for (int axis = 0; axis < 3; axis++) {
      entities[i].center_m[axis] = i == count / 2 ? 0.0 : random_range(random, -1.0, 1.0);
      square += entities[i].center_m[axis] * entities[i].center_m[axis];
    }
    for (int axis = 0; axis < 3 && square > 0.0; axis++)
      entities[i].center_m[axis] *= 3e8 / sqrt(square);
  }
}

/* Nodes visited for a whole plan, all rows: of spacecraft, and of moons. Ten times as many
 * take 42 and 32 times as much, since a receiver still sees most of a hundred one by one; without
 * the tree it is 100 times. */
static void test_a_plan_grows_with_the_number(void **state) {
  (void)state;
  static pl_view_entity entities[MOST];
  test_random random = {.seed = 65};
  print_message("seed 65\n");
  for (int moons = 0; moons < 2; moons++) {
    size_t steps[2];
    for (int k = 0; k < 2; k++) {
      pl_arena arena;
      pl_plan plan;
      pl_arena_init(&arena);
      const size_t count = k == 0 ? 100 : 1000;
      pl_view view = many_entities(&random, entities, count);
      if (moons)
        place_moons(&random, entities, count);
      for (size_t i = 0; i < count; i++)
        entities[i].ggx_alpha_min = 1.0; /* no row is decided by the first entity */
      assert_int_equal(pl_view_tree_build(&arena, &view), PL_OK);
      static bool shadowed[MOST]; /* found once a view, see snapshot_view.c */
      for (size_t i = 0; i < count; i++)
        shadowed[i] = pl_view_shadowed(&view, i);
      const size_t lines = view.tree->steps;
      view.shadowed = shadowed;
      const pl_plan_wish wish = {.tolerance_dn = 0.5};
      assert_int_equal(pl_plan_solve(pl_effects, pl_effect_count, &view, &wish, &plan), PL_OK);
      steps[k] = view.tree->steps - lines;
      pl_arena_clear(&arena);
    }
    print_message("%s: %zu and %zu steps\n", moons ? "moons" : "spacecraft", steps[0], steps[1]);
    assert_true(steps[0] > 100 && steps[1] < 45 * steps[0]);
  }
}

/* Most of a sum is one source's. */
static void test_moons_are_summed_in_groups(void **state) {
  (void)state;
  static pl_view_entity entities[MOST];
  test_random random = {.seed = 64};
  size_t sources[2] = {0, 0};
  pl_arena arena;
  pl_arena_init(&arena);
  print_message("seed 64\n");
  for (int k = 0; k < 2; k++) {
    const size_t count = k == 0 ? 100 : 1600;
    pl_view view = many_entities(&random, entities, count), pairs;
    double over = 0.0;
    size_t calls = 0;
    place_moons(&random, entities, count);
    pairs = view;
    assert_int_equal(pl_view_tree_build(&arena, &view), PL_OK);
    pl_view_weigh(&view, light_of, &calls);
    for (size_t i = 0; i < count; i++) {
      const double exact = pl_view_sum(&pairs, &entities[i], light_of, &calls);
      const double bound = pl_view_sum(&view, &entities[i], light_of, &sources[k]);
      assert_true(bound >= exact * (1.0 - 1e-12));
      over += bound / exact / (double)count;
    }
    print_message("%zu moons: %.3f of the sum, %zu sources\n", count, over, sources[k]);
    assert_true(over < 1.5);
  }
  assert_true(sources[1] < 40 * sources[0]);
  pl_arena_clear(&arena);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_sums_are_bounds),
      cmocka_unit_test(test_shadows_are_the_same),
      cmocka_unit_test(test_moons_are_summed_in_groups),
      cmocka_unit_test(test_work_grows_with_the_number),
      cmocka_unit_test(test_a_plan_grows_with_the_number),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
