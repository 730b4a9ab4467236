/* Instants: making one changes neither what it is made of nor any other, and all of a frame's
 * consumers may use several side by side. */
#include "harness.h"

#include "frame/instant.h"
#include "scenes.h"

enum { SIDE = 48, SAMPLES = 4 };

typedef struct picture {
  pl_vec3f light[SIDE * SIDE];
} picture;

static pl_status take_tile(void *context, const pl_tile_result *result, int worker) {
  picture *out = context;
  (void)worker;
  for (int y = 0; y < result->tile.height; y++)
    for (int x = 0; x < result->tile.width; x++)
      out->light[(result->tile.y0 + y) * SIDE + result->tile.x0 + x] =
          result->radiance[y * PL_TILE_SIDE + x];
  return PL_OK;
}

static void render(const pl_instant *instant, pl_render_scratch *scratch, picture *out) {
  assert_int_equal(
      pl_render(&instant->shot, instant->tracer, &instant->settings, scratch, take_tile, out, NULL),
      PL_OK);
}

/* A cube before a body, in its shadow or beside it. */
static void place(stage *s, double x) {
  s->objects[0].motion = still((pl_vec3){x, 0, 12}, PL_QUAT_IDENTITY);
  s->objects[1].motion = still((pl_vec3){-x, 1, 15}, PL_QUAT_IDENTITY);
}

/* The choice of metering, by a plan that keeps whatever changes anything. */
static pl_choice choice_of(const stage *s, const pl_frame_request *request, pl_arena *arena) {
  const pl_plan_wish wish = {.tolerance_dn = 0.0};
  pl_survey survey;
  pl_plan plan;
  assert_int_equal(pl_survey_place(&s->scene, request, &s->placement, arena, &survey), PL_OK);
  survey.view.white_radiance = 400.0;
  assert_int_equal(pl_survey_plan(&survey, &wish, false, arena, &plan), PL_OK);
  return pl_choice_of_metering(request, &plan, SAMPLES);
}

static void test_instants_do_not_change_each_other(void **state) {
  (void)state;
  stage s;
  pl_arena arena;
  pl_accelerators *kept;
  pl_render_scratch *scratch;
  pl_model *cube = cube_create(0.5);
  static picture alone, other, again;
  stage_init(&s, SIDE, SIDE, 60.0);
  stage_add_object(&s, cube, (pl_vec3){0, 0, 0}, PL_QUAT_IDENTITY, 2.0);
  stage_add_object(&s, cube, (pl_vec3){0, 0, 0}, PL_QUAT_IDENTITY, 1.0);
  stage_add_body(&s, (pl_vec3){0, 0, 40}, (pl_vec3){6, 6, 5}, 0.5f);
  pl_arena_init(&arena);
  assert_int_equal(pl_accelerators_create(&kept), PL_OK);
  assert_int_equal(pl_render_scratch_create(1, &scratch), PL_OK);
  const pl_frame_request request = {.samples = SAMPLES, .placement = s.placement};
  pl_choice culled = choice_of(&s, &request, &arena), quick = culled;
  quick.culls = false;
  culled.tolerance_dn = 1.0;
  culled.subpixel = true;
  for (int k = 0; k < 2; k++) {
    const pl_choice *choice = k == 0 ? &quick : &culled;
    pl_survey first, second;
    const pl_instant *one, *two;
    pl_arena_reset(&arena);
    place(&s, -1.0);
    assert_int_equal(pl_survey_place(&s.scene, &request, &s.placement, &arena, &first), PL_OK);
    first.view.white_radiance = 400.0;
    const pl_survey before = first;
    assert_int_equal(pl_realise(kept, &first, choice, &arena, &one), PL_OK);
    assert_memory_equal(&before, &first, sizeof first);
    assert_true(first.shot.objects[0].kept && first.shot.bodies[0].shadowed);
    render(one, scratch, &alone);
    place(&s, 1.5);
    assert_int_equal(pl_survey_place(&s.scene, &request, &s.placement, &arena, &second), PL_OK);
    second.view.white_radiance = 400.0;
    assert_int_equal(pl_realise(kept, &second, choice, &arena, &two), PL_OK);
    render(two, scratch, &other);
    render(one, scratch, &again);
    assert_memory_equal(&alone, &again, sizeof alone);
    assert_memory_not_equal(&alone, &other, sizeof alone);
  }
  pl_render_scratch_destroy(scratch);
  pl_accelerators_destroy(kept);
  pl_arena_clear(&arena);
  stage_clear(&s);
  pl_model_destroy(cube);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_instants_do_not_change_each_other),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
