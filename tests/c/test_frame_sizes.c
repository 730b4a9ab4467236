/* Frames of odd sizes, from a pixel on, of few entities and none: light is finite, and the same
 * bits by any number of threads. */
#include "frame/frame.h"

#include "frames.h"

enum { KINDS = 36, MESHES = 1, BODIES = 2 };

static const double AU = 149597870700.0;
static const double BROWN[8] = {-0.28, 0.09, 1e-3, -8e-4, -0.012, 0.01, -0.002, 1e-4};

/* Sizes about those of tiles, and tiny ones. */
static int random_size(test_random *random) {
  static const int sizes[] = {1, 2, 3, 31, 32, 33, 47, 64, 65};
  return sizes[random_below(random, sizeof sizes / sizeof *sizes)];
}

static void set_stage(stage *s, const pl_model *model, test_random *random, int kind) {
  const int width = random_size(random), height = random_size(random);
  pl_camera *camera = &s->placement.camera;
  stage_init(s, width, height, random_range(random, 60.0, 100.0));
  s->placement.sun.position_m = (pl_vec3){0.2 * AU, 0.1 * AU, AU * random_range(random, -1, 1)};
  if ((kind % 4) & MESHES)
    for (int i = 0; i < 3; i++)
      stage_add_object(s, model, (pl_vec3){i - 1, random_range(random, -2, 2), 9},
                       random_rotation(random), 2.0);
  if ((kind % 4) & BODIES)
    stage_add_body(s, (pl_vec3){-6, random_range(random, -3, 3), 14}, (pl_vec3){6, 6, 5}, 0.9f);
  if (kind / 4 % 3 == 1)
    assert_int_equal(pl_lens_init(&pl_lens_models[0], BROWN, &camera->lens), PL_OK);
  if (kind / 4 % 3 == 2) {
    camera->aperture_m = 0.05;
    camera->focus_per_m = 0.1;
  }
  if (kind / 12 % 3 > 0) { /* in bands of rows; slowly, so that slices are drawn, and as rows are */
    const double exposure_s = kind / 12 % 3 == 1 ? 1.0 : 1e-6;
    s->placement.shutter = (pl_shutter){.exposure_s = exposure_s, .line_s = 0.02};
    camera->motion.close.t.x = 0.3;
    camera->motion.close.q = pl_quat_axis_angle((pl_vec3){0, 1, 0}, 0.1);
  }
}

/* Renders into a film, all of whose bytes it sets. */
static void shoot(const stage *s, pl_renderer *renderer, const film *f, int samples, int threads) {
  pl_frame_request request = request_all(s, f);
  request.samples = samples;
  request.threads = threads;
  request.wish.tolerance_dn = 1.0;
  render(renderer, &request);
}

static void check_size(const pl_model *model, test_random *random, int kind) {
  stage s;
  film one, several;
  pl_renderer *renderer;
  const int samples = 1 + random_below(random, 9);
  set_stage(&s, model, random, kind);
  film_init(&one, &s);
  film_init(&several, &s);
  assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
  shoot(&s, renderer, &one, samples, 1);
  for (size_t i = 0; i < 3 * one.pixels; i++)
    assert_true(one.radiance[i] >= 0.0f && isfinite(one.radiance[i]));
  for (int threads = 2; threads <= 3; threads++) {
    shoot(&s, renderer, &several, samples, threads);
    if (memcmp(one.memory, several.memory, one.bytes) != 0)
      fail_msg("kind %d, %d samples, %d x %d: %d threads say otherwise than one", kind, samples,
               s.placement.camera.width, s.placement.camera.height, threads);
  }
  pl_renderer_destroy(renderer);
  film_clear(&one);
  film_clear(&several);
  stage_clear(&s);
}

static void test_sizes(void **state) {
  (void)state;
  test_random random = {.seed = 21};
  pl_model *model = cube_create(0.5);
  for (int kind = 0; kind < KINDS; kind++)
    for (int i = 0; i < PL_DRAWS(2, 1); i++)
      check_size(model, &random, kind);
  pl_model_destroy(model);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_sizes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
