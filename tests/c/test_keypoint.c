/* Keypoints of a cube and landmarks of a sphere: seen, hidden, outside, refused. */
#include "harness.h"

#include "frames.h"

enum { WIDTH = 48, HEIGHT = 40, POINTS = 6 };

static void test_keypoints(void **state) {
  (void)state;
  pl_model *cube = cube_create(0.5);
  stage s;
  film f;
  pl_renderer *renderer;
  pl_frame_result result;
  pl_keypoint_label labels[POINTS];
  const pl_keypoint points[POINTS] = {
      {0, 0, {0.0, 0.0, -1.5}, 1e-3}, /* the middle of the front of a cube of 3 m */
      {0, 0, {0.0, 0.0, 1.5}, 1e-3},  /* of its back */
      {0, 0, {0.0, 0.0, -20.0}, 0.0}, /* behind the camera */
      {0, 0, {90.0, 0.0, 0.0}, 0.0},  /* beside the picture */
      {1, 0, {0.0, 0.0, -9.0}, 0.0},  /* on the sphere, behind the cube */
      {1, 0, {0.0, -9.0, 0.0}, 0.0},  /* on its upper rim, which the camera just does not see */
  };
  stage_init(&s, WIDTH, HEIGHT, 40.0);
  stage_add_object(&s, cube, (pl_vec3){0.0, 0.0, 9.0}, (pl_quat){1.0, 0.0, 0.0, 0.0}, 3.0);
  stage_add_body(&s, (pl_vec3){0.0, 0.0, 40.0}, (pl_vec3){9.0, 9.0, 9.0}, 0.5f);
  film_init(&f, &s);
  assert_int_equal(pl_renderer_create(&s.scene, &renderer), PL_OK);
  pl_frame_request request = request_all(&s, &f);
  request.rgb = NULL;
  request.radiance = NULL;
  request.keypoints = points;
  request.keypoint_count = POINTS;
  request.keypoint_labels = labels;
  render(renderer, &request);
  const int32_t visible[POINTS] = {2, 1, 0, 0, 1, 1};
  const int32_t cube_id = s.scene.objects[0].instance_id, ball_id = s.scene.bodies[0].instance_id;
  const int32_t by[POINTS] = {0, cube_id, 0, 0, cube_id, ball_id};
  for (size_t i = 0; i < POINTS; i++) {
    assert_int_equal(labels[i].visible, visible[i]);
    assert_int_equal(labels[i].occluded_by, by[i]);
    assert_true(isnan(labels[i].xy[0]) == (i == 2));
  }
  assert_true(fabs(labels[0].xy[0] - request.placement.camera.cx) < 1e-9);
  assert_true(fabs(labels[0].position[2] - 7.5) < 1e-12);
  const pl_keypoint wrong[] = {{2, 0, {0, 0, 0}, 0}, {0, 1, {0, 0, 0}, 0}, {1, 1, {0, 0, 0}, 0}};
  for (size_t i = 0; i < 3; i++) {
    request.keypoints = &wrong[i];
    request.keypoint_count = 1;
    assert_int_equal(pl_renderer_frame(renderer, &request, &result), PL_E_ARGUMENT);
  }
  pl_renderer_destroy(renderer);
  film_clear(&f);
  stage_clear(&s);
  pl_model_destroy(cube);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_keypoints)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
