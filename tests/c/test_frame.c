/* The frame as a function: the same bits for any threads, order and history; clean ends when
 * cancelled, and on bad requests. That memory runs out is of test_frame_memory.c. */
#include "harness.h"

#include <stdio.h>

#include "frames.h"

enum { WIDTH = 70, HEIGHT = 50 };

/* A glossy cube and a rough one before two bodies, one of which shades the other. */
typedef struct set {
  stage stage;
  pl_model *cube, *soup;
} set;

static void set_init(set *s) {
  test_random random = {.seed = 81};
  s->cube = cube_create(0.5);
  s->soup = soup_create(&random, 60);
  s->cube->materials[0].roughness = 0.3f;
  s->cube->materials[0].metallic = 1.0f;
  stage_init(&s->stage, WIDTH, HEIGHT, 60.0);
  stage_add_object(&s->stage, s->cube, (pl_vec3){-1.5, 0, 6}, random_rotation(&random), 2.0);
  stage_add_object(&s->stage, s->soup, (pl_vec3){1.5, 0, 6}, random_rotation(&random), 1.0);
  stage_add_body(&s->stage, (pl_vec3){0, 4, 30}, (pl_vec3){9, 9, 8}, 0.6f);
  stage_add_body(&s->stage, (pl_vec3){10, -20, 30}, (pl_vec3){3, 3, 3}, 0.3f);
  s->stage.placement.sun.position_m = (pl_vec3){0.5e11, -1.2e11, -0.7e11};
}
static void set_clear(set *s) {
  stage_clear(&s->stage);
  pl_model_destroy(s->cube);
  pl_model_destroy(s->soup);
}

/* A second frame, to compare with the first. */
static void assert_same(const film *a, const film *b) {
  assert_int_equal(a->bytes, b->bytes);
  for (size_t i = 0; i < a->bytes; i++)
    if (a->memory[i] != b->memory[i])
      fail_msg("byte %zu of %zu differs (rgb ends at %zu)", i, a->bytes, 3 * a->pixels);
}

static void test_threads_do_not_matter(void **state) {
  (void)state;
  set s;
  set_init(&s);
  film one, other;
  film_init(&one, &s.stage);
  film_init(&other, &s.stage);
  pl_renderer *renderer;
  assert_int_equal(pl_renderer_create(&s.stage.scene, &renderer), PL_OK);
  for (int automatic = 0; automatic < 2; automatic++) {
    pl_frame_request request = request_all(&s.stage, &one);
    if (automatic)
      request.exposure = (pl_exposure){.automatic = true, .percentile = 90, .key = 0.7};
    const pl_frame_result result = render(renderer, &request);
    for (int threads = 2; threads <= PL_DRAWS(5, 3); threads++) {
      memset(other.memory, 0, other.bytes);
      pl_frame_request again = request_all(&s.stage, &other);
      again.exposure = request.exposure;
      again.threads = threads;
      assert_true(render(renderer, &again).white_radiance == result.white_radiance);
      assert_same(&one, &other);
    }
  }
  pl_renderer_destroy(renderer);
  film_clear(&one);
  film_clear(&other);
  set_clear(&s);
}

/* The same frame after others, by a renderer with another history: objects have moved, been out of
 * the frame, and come back. */
static void test_history_does_not_matter(void **state) {
  (void)state;
  set s;
  set_init(&s);
  film one, other;
  film_init(&one, &s.stage);
  film_init(&other, &s.stage);
  pl_renderer *renderer;
  assert_int_equal(pl_renderer_create(&s.stage.scene, &renderer), PL_OK);
  const pl_frame_request request = request_all(&s.stage, &one);
  render(renderer, &request);
  const pl_motion home = s.stage.objects[0].motion;
  for (int i = 0; i < 4; i++) {
    s.stage.objects[0].motion = still((pl_vec3){i % 2 == 0 ? 1e6 : 0.3, i, 9.0}, PL_QUAT_IDENTITY);
    pl_frame_request between = request_all(&s.stage, &other);
    between.index = (uint64_t)i + 5;
    between.samples = 4 + i;
    render(renderer, &between);
    assert_memory_not_equal(one.rgb, other.rgb, 3 * one.pixels);
  }
  s.stage.objects[0].motion = home;
  memset(other.memory, 0, other.bytes);
  const pl_frame_request again = request_all(&s.stage, &other);
  render(renderer, &again);
  assert_same(&one, &other);
  pl_renderer_destroy(renderer);
  film_clear(&one);
  film_clear(&other);
  set_clear(&s);
}

/* Other seeds and other frames are other noise. */
static void test_keys_matter(void **state) {
  (void)state;
  set s;
  set_init(&s);
  film one, other;
  film_init(&one, &s.stage);
  film_init(&other, &s.stage);
  pl_renderer *renderer;
  assert_int_equal(pl_renderer_create(&s.stage.scene, &renderer), PL_OK);
  pl_frame_request request = request_all(&s.stage, &one);
  render(renderer, &request);
  for (int i = 0; i < 2; i++) {
    pl_frame_request again = request_all(&s.stage, &other);
    again.seed += i == 0;
    again.index += i == 1;
    render(renderer, &again);
    assert_memory_not_equal(one.radiance, other.radiance, 3 * one.pixels * sizeof(float));
    assert_memory_equal(film_channel(&one, "depth"), film_channel(&other, "depth"),
                        one.pixels * sizeof(float));
  }
  pl_renderer_destroy(renderer);
  film_clear(&one);
  film_clear(&other);
  set_clear(&s);
}

/* --- cancelling ------------------------------------------------------------------------------- */

static bool stop_after(void *context) {
  int *left = context;
  return (*left)-- <= 0;
}

static void test_cancel(void **state) {
  (void)state;
  set s;
  set_init(&s);
  film f;
  film_init(&f, &s.stage);
  pl_renderer *renderer;
  assert_int_equal(pl_renderer_create(&s.stage.scene, &renderer), PL_OK);
  for (int polls = 0; polls < 4; polls++)
    for (int threads = 1; threads <= 2; threads++) {
      int left = polls;
      pl_cancel cancel = {.poll = stop_after, .context = &left};
      pl_frame_request request = request_all(&s.stage, &f);
      pl_frame_result result;
      request.cancel = &cancel;
      request.threads = threads;
      /* Two threads may be done before the caller's thread asks again. */
      const pl_status status = pl_renderer_frame(renderer, &request, &result);
      assert_true(status == PL_E_CANCELLED || (threads == 2 && polls > 0 && status == PL_OK));
      request.cancel = NULL;
      render(renderer, &request);
    }
  pl_cancel asked;
  memset(&asked, 0, sizeof asked);
  atomic_store(&asked.requested, true);
  pl_frame_request request = request_all(&s.stage, &f);
  pl_frame_result result;
  request.cancel = &asked;
  assert_int_equal(pl_renderer_frame(renderer, &request, &result), PL_E_CANCELLED);
  pl_renderer_destroy(renderer);
  film_clear(&f);
  set_clear(&s);
}

/* --- requests --------------------------------------------------------------------------------- */

static void refuse(pl_renderer *renderer, pl_frame_request request, const char *word) {
  pl_frame_result result;
  assert_int_equal(pl_renderer_frame(renderer, &request, &result), PL_E_RANGE);
  if (strstr(pl_error_text(), word) == NULL)
    fail_msg("'%s' does not say '%s'", pl_error_text(), word);
}

static void test_bad_requests(void **state) {
  (void)state;
  set s;
  set_init(&s);
  film f;
  film_init(&f, &s.stage);
  pl_renderer *renderer;
  assert_int_equal(pl_renderer_create(&s.stage.scene, &renderer), PL_OK);
  const pl_frame_request good = request_all(&s.stage, &f);
  pl_frame_request bad = good;
  bad.samples = 0;
  refuse(renderer, bad, "samples");
  bad = good;
  bad.max_bounces = -1;
  refuse(renderer, bad, "max_bounces");
  bad = good;
  bad.wish.tolerance_dn = NAN;
  refuse(renderer, bad, "tolerance_dn");
  bad = good;
  bad.exposure.white_radiance = 0.0;
  refuse(renderer, bad, "white_radiance");
  bad = good;
  bad.exposure = (pl_exposure){.automatic = true, .percentile = 101, .key = 1};
  refuse(renderer, bad, "percentile");
  bad = good;
  bad.threads = 0;
  refuse(renderer, bad, "threads");
  bad = good;
  bad.placement.camera.fx = NAN;
  refuse(renderer, bad, "camera");
  render(renderer, &good);
  pl_renderer_destroy(renderer);
  film_clear(&f);
  set_clear(&s);
}

/* Only what is asked for is written, and each label alone is what it is among all. */
static void test_parts_of_a_request(void **state) {
  (void)state;
  set s;
  set_init(&s);
  film all, part;
  film_init(&all, &s.stage);
  film_init(&part, &s.stage);
  pl_renderer *renderer;
  assert_int_equal(pl_renderer_create(&s.stage.scene, &renderer), PL_OK);
  const pl_frame_request request = request_all(&s.stage, &all);
  render(renderer, &request);
  for (size_t i = 0; i < pl_channel_count; i++) {
    pl_frame_request one = request;
    memset(part.memory, 0xa5, part.bytes);
    one.rgb = NULL;
    one.radiance = NULL;
    one.objects = NULL;
    one.masks = NULL;
    memset(one.channels, 0, sizeof one.channels);
    one.channels[i] = part.channels[i];
    render(renderer, &one);
    const size_t bytes =
        part.pixels * pl_channels[i].element * pl_channel_elements(&pl_channels[i], 2);
    assert_memory_equal(part.channels[i], all.channels[i], bytes);
    assert_int_equal(part.rgb[0], 0xa5);
  }
  pl_renderer_destroy(renderer);
  film_clear(&all);
  film_clear(&part);
  set_clear(&s);
}

static void test_empty_scene(void **state) {
  (void)state;
  stage s;
  film f;
  stage_init(&s, 33, 17, 20.0);
  film_init(&f, &s);
  memset(f.memory, 0xa5, f.bytes);
  pl_renderer *renderer;
  assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
  pl_frame_request request = request_all(&s, &f);
  request.exposure = (pl_exposure){.automatic = true, .percentile = 90, .key = 0.7};
  render(renderer, &request);
  const float *depth = film_channel(&f, "depth");
  for (size_t i = 0; i < f.pixels; i++)
    assert_true(f.rgb[3 * i] == 0 && f.radiance[3 * i] == 0.0f && depth[i] == 0.0f);
  pl_renderer_destroy(renderer);
  film_clear(&f);
  stage_clear(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_threads_do_not_matter), serial_unit_test(test_history_does_not_matter),
      serial_unit_test(test_keys_matter),           cmocka_unit_test(test_cancel),
      serial_unit_test(test_bad_requests),          serial_unit_test(test_parts_of_a_request),
      serial_unit_test(test_empty_scene),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
