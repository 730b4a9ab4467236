/* Instants: making one changes neither what it is made of nor any other, and all of a frame's
 * consumers may use several side by side. */
#include "harness.h"

#include <stdlib.h>

#include "airs.h"
#include "instants.h"
#include "render/path.h"

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

static void test_instants_do_not_change_each_other(void **state) {
  (void)state;
  studio s;
  static picture alone, other, again;
  studio_init(&s, SIDE, 60.0, 0.5);
  stage_add_object(&s.stage, s.cube, (pl_vec3){0, 0, 0}, PL_QUAT_IDENTITY, 2.0);
  stage_add_object(&s.stage, s.cube, (pl_vec3){0, 0, 0}, PL_QUAT_IDENTITY, 1.0);
  stage_add_body(&s.stage, (pl_vec3){0, 0, 40}, (pl_vec3){6, 6, 5}, 0.5f);
  const pl_frame_request request = {.samples = SAMPLES, .placement = s.stage.placement};
  pl_survey planned = studio_survey(&s, &request);
  pl_choice culled = studio_choice(&s, &request, &planned, SAMPLES), plain = culled;
  plain.culls = false;
  culled.tolerance_dn = 1.0;
  culled.subpixel = true;
  for (int k = 0; k < 2; k++) {
    const pl_choice *choice = k == 0 ? &plain : &culled;
    pl_arena_reset(&s.arena);
    place(&s.stage, -1.0);
    const pl_survey first = studio_survey(&s, &request), before = first;
    const pl_instant *one = studio_realise(&s, &first, choice);
    assert_memory_equal(&before, &first, sizeof first);
    assert_true(first.shot.objects[0].kept && first.shot.bodies[0].shadowed);
    render(one, s.scratch, &alone);
    place(&s.stage, 1.5);
    const pl_survey second = studio_survey(&s, &request);
    render(studio_realise(&s, &second, choice), s.scratch, &other);
    render(one, s.scratch, &again);
    assert_memory_equal(&alone, &again, sizeof alone);
    assert_memory_not_equal(&alone, &other, sizeof alone);
  }
  studio_clear(&s);
}

/* Counts allocations of some sizes. */
typedef struct tally {
  size_t sizes[2];
  int found[2];
} tally;

static void *allocate_counted(void *context, size_t size) {
  tally *t = context;
  for (int i = 0; i < 2; i++)
    t->found[i] += size == t->sizes[i];
  return malloc(size);
}

/* Renders without or with the irradiance filter and air; `made`: buffers made so
 * far. */
static void render_with(const pl_instant *instant, bool filter, bool air, tally *made,
                        pl_render_scratch *scratch, picture *out) {
  pl_render_settings settings = instant->settings;
  settings.noise_dn = filter ? 1.0f : 0.0f;
  if (!air)
    settings.air = NULL;
  pl_memory_hook(allocate_counted, made);
  const pl_status status =
      pl_render(&instant->shot, instant->tracer, &settings, scratch, take_tile, out, NULL);
  pl_memory_hook(NULL, NULL);
  assert_int_equal(status, PL_OK);
}

/* Buffers of the irradiance filter and of air are made by the first frame that has them, and only
 * then. Frames without them have the same bits before and after. */
static void test_effects_that_are_off_have_no_buffers(void **state) {
  (void)state;
  studio s;
  test_random random = {.seed = 5};
  tally made = {.sizes = {PL_TILE_PIXELS * sizeof(pl_pixel_patches), sizeof(pl_air_tile)}};
  static picture off, filtered, airy, again;
  const pl_air_settings settings = random_air(&random, 6.0, 0.05, 0.3);
  pl_air *air = air_create(&settings, 6.0);
  studio_init(&s, SIDE, 60.0, 0.5);
  stage_add_object(&s.stage, s.cube, (pl_vec3){-1, 0, 12}, PL_QUAT_IDENTITY, 2.0);
  const size_t body = stage_add_body(&s.stage, (pl_vec3){0, 0, 40}, (pl_vec3){6, 6, 6}, 0.5f);
  s.stage.scene.bodies[body].air = air;
  const pl_frame_request request = {.samples = SAMPLES, .placement = s.stage.placement};
  pl_survey survey = studio_survey(&s, &request);
  const pl_choice choice = studio_choice(&s, &request, &survey, SAMPLES);
  const pl_instant *instant = studio_realise(&s, &survey, &choice);
  assert_true(instant->settings.air != NULL && made.sizes[0] > 400000 && made.sizes[1] > 130000);
  const bool with[4][2] = {{false, false}, {true, false}, {false, true}, {false, false}};
  picture *pictures[4] = {&off, &filtered, &airy, &again};
  for (int i = 0; i < 4; i++) {
    render_with(instant, with[i][0], with[i][1], &made, s.scratch, pictures[i]);
    assert_int_equal(made.found[0], i >= 1);
    assert_int_equal(made.found[1], i >= 2);
  }
  assert_memory_equal(&off, &again, sizeof off);
  assert_memory_not_equal(&off, &filtered, sizeof off);
  assert_memory_not_equal(&off, &airy, sizeof off);
  studio_clear(&s);
  pl_air_destroy(air);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_instants_do_not_change_each_other),
      cmocka_unit_test(test_effects_that_are_off_have_no_buffers),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
