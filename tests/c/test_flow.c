/* Channels of motion on cubes and spheres: a frame beside itself, beside a moved camera, and
 * without memory. */
#include "harness.h"

#include "frames.h"

enum { WIDTH = 48, HEIGHT = 40, PIXELS = WIDTH * HEIGHT };

typedef struct fixture {
  stage stage;
  pl_model *cube;
  film film;
  pl_renderer *renderer;
  pl_frame_request request;
  pl_other_frame other;
} fixture;

static void fixture_init(fixture *f) {
  memset(f, 0, sizeof *f);
  f->cube = cube_create(0.5);
  stage_init(&f->stage, WIDTH, HEIGHT, 40.0);
  stage_add_object(&f->stage, f->cube, (pl_vec3){1.0, -0.5, 9.0},
                   pl_quat_unit((pl_quat){0.9, 0.2, -0.3, 0.1}), 3.0);
  stage_add_body(&f->stage, (pl_vec3){-4.0, 2.0, 40.0}, (pl_vec3){12.0, 12.0, 10.0}, 0.5f);
  film_init(&f->film, &f->stage);
  assert_int_equal(pl_renderer_create(&f->stage.scene, &f->renderer), PL_OK);
  f->request = request_all(&f->stage, &f->film);
  f->request.rgb = NULL;
  f->request.radiance = NULL;
  f->other.placement = f->request.placement;
  f->request.others[PL_FLOW_NEXT] = f->request.others[PL_FLOW_PREVIOUS] = &f->other;
}
static void fixture_clear(fixture *f) {
  pl_renderer_destroy(f->renderer);
  film_clear(&f->film);
  stage_clear(&f->stage);
  pl_model_destroy(f->cube);
}

static bool hit(const fixture *f, size_t i) {
  return ((const int32_t *)film_channel(&f->film, "instance"))[i] != 0;
}

/* Everything is where it was, and is seen. */
static void test_beside_itself(void **state) {
  (void)state;
  fixture f;
  fixture_init(&f);
  render(f.renderer, &f.request);
  const float *flow = film_channel(&f.film, "flow"), *back = film_channel(&f.film, "flow_backward");
  const float *moved = film_channel(&f.film, "scene_flow");
  const uint8_t *hidden = film_channel(&f.film, "flow_occlusion");
  size_t hits = 0;
  for (size_t i = 0; i < PIXELS; i++) {
    for (size_t k = 0; k < 2; k++) {
      assert_true(fabsf(flow[2 * i + k]) < 1e-6f);
      assert_true(fabsf(back[2 * i + k]) < 1e-6f);
    }
    assert_int_equal(hidden[i], 0);
    for (size_t k = 0; k < 3; k++)
      assert_true(hit(&f, i) ? fabsf(moved[3 * i + k]) < 1e-6f : isnan(moved[3 * i + k]));
    hits += hit(&f, i);
  }
  assert_in_range(hits, 200, PIXELS - 200);
  fixture_clear(&f);
}

/* A camera that steps aside: parallax by depth, and none of what is at infinity. */
static void test_beside_a_moved_camera(void **state) {
  (void)state;
  fixture f;
  fixture_init(&f);
  const pl_vec3 step = {0.5, -0.25, 1.0};
  f.other.placement.camera.motion = still(step, f.request.placement.camera.motion.open.q);
  render(f.renderer, &f.request);
  const float *flow = film_channel(&f.film, "flow"), *depth = film_channel(&f.film, "depth");
  const uint8_t *hidden = film_channel(&f.film, "flow_occlusion");
  const pl_camera *camera = &f.request.placement.camera;
  size_t covered = 0;
  for (size_t i = 0; i < PIXELS; i++) {
    const double x = (double)(i % WIDTH) - camera->cx, y = (double)(i / WIDTH) - camera->cy;
    const double z = hit(&f, i) ? (double)depth[i] : INFINITY;
    const double u = (x - camera->fx * step.x / z) / (1.0 - step.z / z);
    const double v = (y - camera->fy * step.y / z) / (1.0 - step.z / z);
    assert_true(fabs((double)flow[2 * i] - (u - x)) < 1e-4);
    assert_true(fabs((double)flow[2 * i + 1] - (v - y)) < 1e-4);
    const bool inside = fabs(u + camera->cx - 0.5 * (WIDTH - 1)) < 0.5 * WIDTH - 0.01 &&
                        fabs(v + camera->cy - 0.5 * (HEIGHT - 1)) < 0.5 * HEIGHT - 0.01;
    covered += inside && hidden[i] != 0;
  }
  assert_in_range(covered, 10, PIXELS / 2);
  fixture_clear(&f);
}

/* Without another frame nothing has a motion. */
static void test_beside_none(void **state) {
  (void)state;
  fixture f;
  fixture_init(&f);
  f.request.others[PL_FLOW_NEXT] = f.request.others[PL_FLOW_PREVIOUS] = NULL;
  render(f.renderer, &f.request);
  const float *flow = film_channel(&f.film, "flow"), *moved = film_channel(&f.film, "scene_flow");
  const uint8_t *hidden = film_channel(&f.film, "flow_occlusion_backward");
  for (size_t i = 0; i < PIXELS; i++)
    assert_true(isnan(flow[2 * i]) && isnan(flow[2 * i + 1]) && isnan(moved[3 * i]) &&
                hidden[i] == 1);
  fixture_clear(&f);
}

/* A placement that is not valid is refused, and named. */
static void test_bad_placement(void **state) {
  (void)state;
  fixture f;
  fixture_init(&f);
  pl_frame_result result;
  f.other.placement.camera.motion =
      still((pl_vec3){NAN, 0.0, 0.0}, f.request.placement.camera.motion.open.q);
  assert_int_equal(pl_renderer_frame(f.renderer, &f.request, &result), PL_E_RANGE);
  fixture_clear(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_beside_itself),
      cmocka_unit_test(test_beside_a_moved_camera),
      cmocka_unit_test(test_beside_none),
      cmocka_unit_test(test_bad_placement),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
