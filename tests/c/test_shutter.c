/* The world at instants of an exposure. */
#include "harness.h"

#include "scene/shutter.h"
#include "scenes.h"

static void assert_turn(pl_quat q, pl_quat expected) {
  const double dot = q.w * expected.w + q.x * expected.x + q.y * expected.y + q.z * expected.z;
  assert_true(fabs(fabs(dot) - 1.0) < 1e-12);
}

static pl_quat about_z(double angle_rad) {
  return pl_quat_axis_angle((pl_vec3){0.0, 0.0, 1.0}, angle_rad);
}

static pl_quat negative(pl_quat q) { return (pl_quat){-q.w, -q.x, -q.y, -q.z}; }

static void test_between_two_poses(void **state) {
  (void)state;
  for (int flip = 0; flip < 2; flip++) { /* q and -q are one rotation */
    const pl_quat end = about_z(1.0);
    const pl_motion motion = {.open = {{0, 0, 0}, about_z(0.0)},
                              .close = {{4, 8, -2}, flip ? negative(end) : end}};
    for (int i = 0; i <= 10; i++) {
      const double u = 0.1 * i;
      const pl_pose pose = pl_motion_at(&motion, u);
      assert_true(fabs(pose.t.x - 4.0 * u) < 1e-15 && fabs(pose.t.y - 8.0 * u) < 1e-14);
      assert_turn(pose.q, about_z(u));
    }
    assert_turn(pl_motion_middle(&motion).q, about_z(0.5));
  }
}

/* A turn of 300 degrees in all: by keys the long way round, whatever their signs. */
static void test_keys(void **state) {
  (void)state;
  pl_pose keys[5];
  for (int k = 0; k < 5; k++) {
    const double angle = k * 300.0 / 4.0 * PL_PI / 180.0;
    keys[k] = (pl_pose){{cos(angle), sin(angle), 0.0}, about_z(angle)};
    if (k % 2 == 1)
      keys[k].q = negative(keys[k].q);
  }
  const pl_motion motion = {.open = keys[0], .close = keys[4], .keys = keys, .key_count = 5};
  for (int i = 0; i <= 40; i++)
    assert_turn(pl_motion_at(&motion, i / 40.0).q, about_z(i / 40.0 * 300.0 * PL_PI / 180.0));
  for (int k = 0; k < 5; k++) {
    const pl_pose pose = pl_motion_at(&motion, k / 4.0);
    assert_true(pl_vec3_norm(pl_vec3_sub(pose.t, keys[k].t)) < 1e-15);
  }
  const pl_pose middle = pl_motion_middle(&motion);
  assert_memory_equal(&middle, &keys[2], sizeof middle);
  /* Straight from key to key. */
  assert_true(fabs(pl_motion_at(&motion, 0.125).t.x - 0.5 * (keys[0].t.x + keys[1].t.x)) < 1e-15);
}

static void test_placement(void **state) {
  (void)state;
  stage s;
  pl_arena arena;
  pl_placement now;
  pl_pose keys[3] = {
      {{0, 0, 0}, PL_QUAT_IDENTITY}, {{1, 0, 0}, PL_QUAT_IDENTITY}, {{5, 0, 0}, PL_QUAT_IDENTITY}};
  pl_model *cube = cube_create(0.5);
  stage_init(&s, 8, 6, 10.0);
  stage_add_object(&s, cube, (pl_vec3){0, 0, 5}, PL_QUAT_IDENTITY, 1.0);
  stage_add_body(&s, (pl_vec3){0, 0, 50}, (pl_vec3){1, 1, 1}, 0.5f);
  s.placement.shutter = (pl_shutter){.exposure_s = 3.0, .line_s = 0.2};
  assert_true(fabs(pl_shutter_window_s(&s.placement) - 4.0) < 1e-15);
  s.objects[0].motion =
      (pl_motion){.open = keys[0], .close = keys[2], .keys = keys, .key_count = 3};
  s.placement.camera.motion = s.objects[0].motion;
  pl_arena_init(&arena);
  assert_int_equal(pl_placement_check(&s.scene, &s.placement), PL_OK);
  assert_int_equal(pl_placement_at(&s.scene, &s.placement, 0.75, &arena, &now), PL_OK);
  assert_true(fabs(now.objects[0].motion.open.t.x - 3.0) < 1e-15);
  assert_true(now.objects[0].motion.close.t.x == now.objects[0].motion.open.t.x);
  assert_true(now.objects[0].motion.keys == NULL && now.shutter.exposure_s == 0.0);
  assert_true(now.bodies[0].motion.open.t.z == 50.0);
  /* Keys that do not tell what is between hold to halfway; beyond the ends nothing is. */
  s.placement.shutter.held = true;
  const double u[5] = {-1.0, 0.2, 0.3, 0.7, 2.0}, x[5] = {0.0, 0.0, 1.0, 1.0, 5.0};
  for (int i = 0; i < 5; i++) {
    assert_int_equal(pl_placement_at(&s.scene, &s.placement, u[i], &arena, &now), PL_OK);
    assert_true(now.camera.motion.open.t.x == x[i]);
  }
  s.objects[0].motion.key_count = 2;
  assert_int_equal(pl_placement_check(&s.scene, &s.placement), PL_E_RANGE);
  pl_arena_clear(&arena);
  stage_clear(&s);
  pl_model_destroy(cube);
}

/* A cube at 10 m that goes 0.5 m across in the exposure, seen with 100 px a radian: 5 px, and at
 * its front side, 0.5 m nearer, 5.3. With rows in all of the same time the halves. */
static void test_measure(void **state) {
  (void)state;
  stage s;
  pl_arena arena;
  pl_snapshot shot;
  pl_view view = {0};
  pl_model *cube = cube_create(0.5);
  stage_init(&s, 40, 31, 100.0);
  stage_add_object(&s, cube, (pl_vec3){0, 0, 10}, PL_QUAT_IDENTITY, 1.0);
  pl_arena_init(&arena);
  s.objects[0].motion.close.t.x = 0.5;
  s.placement.shutter.exposure_s = 2.0;
  assert_int_equal(pl_snapshot_build(&s.scene, &s.placement, &arena, &shot), PL_OK);
  pl_shutter_measure(&s.placement, &shot, false, &view);
  assert_true(view.blur_px > 5.3 && view.blur_px < 7.0 && view.skew_px == 0.0);
  const double all = view.blur_px;
  s.placement.shutter = (pl_shutter){.exposure_s = 1.0, .line_s = 1.0 / 30};
  pl_shutter_measure(&s.placement, &shot, false, &view);
  assert_true(fabs(view.blur_px - 0.5 * all) < 1e-9 && fabs(view.skew_px - 0.5 * all) < 1e-9);
  /* A camera that goes along sees nothing move. */
  s.placement.camera.motion.close.t.x = 0.5;
  pl_shutter_measure(&s.placement, &shot, false, &view);
  assert_true(view.blur_px == 0.0 && view.skew_px == 0.0);
  pl_arena_clear(&arena);
  stage_clear(&s);
  pl_model_destroy(cube);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_between_two_poses),
      cmocka_unit_test(test_keys),
      cmocka_unit_test(test_placement),
      cmocka_unit_test(test_measure),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
