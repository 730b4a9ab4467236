/* Re-basing on the camera, what is in the frame, culling. */
#include "harness.h"

#include <stdio.h>

#include "geom/ellipsoid.h"
#include "light/occultation.h"
#include "scenes.h"
#include "scene/snapshot.h"

static const double AU = 149597870700.0;

static pl_status build(stage *s, pl_arena *arena, pl_snapshot *shot, pl_view *view) {
  pl_arena_reset(arena);
  PL_TRY(pl_snapshot_build(&s->scene, &s->placement, arena, shot));
  PL_TRY(pl_snapshot_view(shot, arena, view));
  view->white_radiance = 100.0;
  view->samples = 16;
  view->max_bounces = 4;
  return PL_OK;
}

/* Everything 1e11 m from the root's origin: offsets that doubles can hold there come out exact. */
static void test_rebasing_is_exact(void **state) {
  (void)state;
  test_random random = {.seed = 51};
  pl_model *model = cube_create(0.5);
  pl_arena arena;
  pl_arena_init(&arena);
  print_message("seed 51\n");
  for (int i = 0; i < 200; i++) {
    const double ulp = 0x1p-16; /* of 1e11: positions are multiples of it */
    const pl_vec3 far = pl_vec3_scale(random_direction(&random), 1e11);
    const pl_vec3 camera = {ulp * rint(far.x / ulp), ulp * rint(far.y / ulp),
                            ulp * rint(far.z / ulp)};
    const pl_vec3 offset = {ulp * random_below(&random, 1 << 20), ulp * random_below(&random, 9999),
                            2.0 + ulp * random_below(&random, 9999)};
    stage s;
    pl_snapshot shot;
    pl_view view;
    stage_init(&s, 64, 48, 60.0);
    s.placement.camera.motion = still(camera, PL_QUAT_IDENTITY);
    stage_add_object(&s, model, pl_vec3_add(camera, offset), PL_QUAT_IDENTITY, 2.0);
    assert_int_equal(build(&s, &arena, &shot, &view), PL_OK);
    const pl_vec3 p = shot.objects[0].position;
    assert_true(p.x == offset.x && p.y == offset.y && p.z == offset.z);
    const double floats[3] = {offset.x, offset.y, offset.z};
    for (int k = 0; k < 3; k++)
      assert_true(fabs((double)shot.objects[0].to_view[9 + k] - floats[k]) <=
                  0x1p-24 * fabs(floats[k]));
    assert_true(shot.objects[0].to_view[0] == 2.0f && shot.objects[0].to_view[8] == 2.0f);
    assert_true(fabs(view.entities[0].distance_m - pl_vec3_norm(offset)) < 1e-9);
    stage_clear(&s);
  }
  pl_arena_clear(&arena);
  pl_model_destroy(model);
}

/* The middle of the exposure is what counts. */
static void test_middle_of_the_exposure(void **state) {
  (void)state;
  const pl_quat turn = pl_quat_axis_angle((pl_vec3){0, 0, 1}, 1.0);
  const pl_motion motion = {.open = {{0, 0, 10}, PL_QUAT_IDENTITY}, .close = {{4, 2, 10}, turn}};
  const pl_pose middle = pl_motion_middle(&motion);
  assert_true(middle.t.x == 2.0 && middle.t.y == 1.0 && middle.t.z == 10.0);
  const pl_vec3 x = pl_quat_rotate(middle.q, (pl_vec3){1, 0, 0});
  assert_true(fabs(x.x - cos(0.5)) < 1e-12 && fabs(x.y - sin(0.5)) < 1e-12);
}

/* Random spheres around and before random cameras: one whose point lies in the image is in frame.
 */
static void test_in_frame_is_conservative(void **state) {
  (void)state;
  test_random random = {.seed = 52};
  int seen = 0, claimed = 0;
  pl_arena arena;
  pl_arena_init(&arena);
  print_message("seed 52\n");
  for (int i = 0; i < 3000; i++) {
    stage s;
    pl_snapshot shot;
    pl_view view;
    stage_init(&s, 64, 48, random_scale(&random, 10, 1e4));
    pl_camera *camera = &s.placement.camera;
    camera->fy = camera->fx * random_range(&random, 0.5, 2.0);
    camera->cx = random_range(&random, -50, 110);
    camera->cy = random_range(&random, -30, 80);
    camera->skew = camera->fx * random_range(&random, -0.3, 0.3);
    camera->motion = still((pl_vec3){1e9, 2e9, -1e9}, random_rotation(&random));
    const pl_mat3 to_root = pl_mat3_from_quat(camera->motion.open.q);
    const double distance = random_scale(&random, 1, 1e9);
    const double radius = distance * random_scale(&random, 1e-4, 0.9);
    const pl_vec3 aim =
        pl_vec3_unit(pl_mat3_mul_vec(to_root, pl_camera_ray(camera, random_range(&random, -60, 120),
                                                            random_range(&random, -50, 100))));
    const pl_vec3 center =
        pl_vec3_scale(random_unit(&random) < 0.2 ? random_direction(&random) : aim, distance);
    stage_add_body(&s, pl_vec3_add(camera->motion.open.t, center),
                   (pl_vec3){radius, radius, radius}, 0.5f);
    assert_int_equal(build(&s, &arena, &shot, &view), PL_OK);
    bool hit = false;
    for (int k = 0; k < 300 && !hit; k++) {
      const pl_vec3 ray = pl_vec3_unit(
          pl_mat3_mul_vec(to_root, pl_camera_ray(camera, random_range(&random, -0.5, 63.5),
                                                 random_range(&random, -0.5, 47.5))));
      const pl_vec3 r = {radius, radius, radius};
      double t;
      hit = pl_ellipsoid_intersect(r, pl_vec3_scale(center, -1.0), ray, 0.0, &t);
    }
    seen += hit;
    claimed += shot.bodies[0].in_frame;
    assert_true(!hit || shot.bodies[0].in_frame);
    assert_int_equal(view.entities[0].in_frame, shot.bodies[0].in_frame);
    stage_clear(&s);
  }
  print_message("seen %d, claimed %d of 3000\n", seen, claimed);
  assert_true(seen > 500 && claimed < 2700);
  pl_arena_clear(&arena);
}

static pl_snapshot culled(const pl_snapshot *shot, const pl_view *view, pl_arena *arena) {
  const pl_culling culling = {.view = view, .tolerance_dn = 0.5};
  pl_snapshot out;
  assert_int_equal(pl_snapshot_cull(shot, &culling, arena, &out), PL_OK);
  return out;
}

/* Objects scattered about a frame: one with a vertex in the image, or on the way from the sun to a
 * vertex that is in the image, is kept. */
static void test_culling_keeps_what_matters(void **state) {
  (void)state;
  test_random random = {.seed = 53};
  pl_model *model = cube_create(0.5);
  model->materials[0].lambert = true; /* Lambert: no mirrors, which would keep everything */
  int needed = 0, dropped = 0;
  pl_arena arena;
  pl_arena_init(&arena);
  print_message("seed 53\n");
  for (int i = 0; i < 400; i++) {
    stage s;
    pl_snapshot shot;
    pl_view view;
    stage_init(&s, 64, 48, 200.0);
    const pl_vec3 sun = random_direction(&random);
    s.placement.sun.position_m = pl_vec3_scale(sun, AU);
    stage_add_object(&s, model, (pl_vec3){0, 0, 40}, random_rotation(&random), 3.0);
    for (int k = 0; k < 8; k++) {
      pl_vec3 place = pl_vec3_scale(random_direction(&random), random_scale(&random, 5, 5000));
      if (k % 2 == 0) /* about the line to the sun */
        place = pl_vec3_madd(pl_vec3_madd((pl_vec3){0, 0, 40}, random_scale(&random, 3, 300), sun),
                             4.0, random_direction(&random));
      stage_add_object(&s, model, place, random_rotation(&random), random_scale(&random, 0.1, 3.0));
    }
    assert_int_equal(build(&s, &arena, &shot, &view), PL_OK);
    view.max_bounces = i % 2 == 0 ? 0 : 4;
    shot = culled(&shot, &view, &arena);
    assert_true(shot.objects[0].kept);
    for (size_t k = 1; k < shot.object_count; k++) {
      const pl_shot_object *object = &shot.objects[k];
      const pl_vec3 to_center = pl_vec3_sub(object->center, shot.objects[0].center);
      const double along = pl_vec3_dot(to_center, sun);
      const double across = pl_vec3_norm(pl_vec3_madd(to_center, -along, sun));
      const bool shades = along > 0.0 && across < 0.5 * object->scale + 0.5 * 3.0;
      bool visible = false;
      for (size_t v = 0; v < model->vertex_count && !visible; v++) {
        const pl_vec3 p =
            pl_vec3_add(object->position,
                        pl_mat3_mul_vec(object->rotation,
                                        pl_vec3_scale(model_vertex(model, v), object->scale)));
        visible = p.z > 0.0 && fabs(p.x / p.z * 200.0) < 32.0 && fabs(p.y / p.z * 200.0) < 24.0;
      }
      needed += shades || visible;
      dropped += !object->kept;
      assert_true(object->kept || !(shades || visible));
    }
    stage_clear(&s);
  }
  print_message("needed %d, dropped %d of 3200\n", needed, dropped);
  assert_true(needed > 300 && dropped > 300);
  pl_arena_clear(&arena);
  pl_model_destroy(model);
}

/* A black screen off the frame, between what is seen and a lit body: it takes away light. */
static void test_culling_keeps_black_screens(void **state) {
  (void)state;
  pl_model *seen = cube_create(0.5), *screen = square_create(3.0);
  seen->materials[0].lambert = screen->materials[0].lambert = true;
  for (int k = 0; k < 3; k++)
    screen->materials[0].base_color[k] = 0.0f;
  stage s;
  pl_arena arena;
  pl_snapshot shot;
  pl_view view;
  pl_arena_init(&arena);
  stage_init(&s, 64, 48, 200.0);
  stage_add_object(&s, seen, (pl_vec3){0, 0, 20}, PL_QUAT_IDENTITY, 1.0);
  stage_add_object(&s, screen, (pl_vec3){-20, 0, 20},
                   pl_quat_axis_angle((pl_vec3){0, 1, 0}, PL_PI / 2), 1.0);
  stage_add_body(&s, (pl_vec3){-7e6, 0, 20}, (pl_vec3){6.4e6, 6.4e6, 6.4e6}, 0.8f);
  s.placement.sun.position_m = (pl_vec3){0, AU, 0};
  assert_int_equal(build(&s, &arena, &shot, &view), PL_OK);
  assert_false(shot.objects[1].in_frame);
  assert_true(culled(&shot, &view, &arena).objects[1].kept);
  view.max_bounces = 0; /* then the body lights nothing */
  assert_false(culled(&shot, &view, &arena).objects[1].kept);
  assert_true(shot.objects[1].kept); /* it stays as it was */
  stage_clear(&s);
  pl_arena_clear(&arena);
  pl_model_destroy(seen);
  pl_model_destroy(screen);
}

/* An object is dark where the exact light at every place of its sphere is 0, and not much further
 * in than it has to be: places of it are lit, or it is within a hundredth of the umbra's edge. */
static void test_dark_is_without_sun(void **state) {
  (void)state;
  test_random random = {.seed = 54};
  pl_model *model = cube_create(0.5);
  int dark = 0, lit = 0;
  pl_arena arena;
  pl_arena_init(&arena);
  print_message("seed 54\n");
  for (int i = 0; i < 2000; i++) {
    stage s;
    pl_snapshot shot;
    pl_view view;
    stage_init(&s, 64, 48, 200.0);
    const pl_vec3 sun = random_direction(&random), here = {0, 0, 40};
    s.placement.sun.position_m = pl_vec3_scale(sun, AU);
    const double radius = random_scale(&random, 1e3, 6e6), size = random_scale(&random, 0.1, 20.0);
    const double far = radius * random_scale(&random, 1.01, 300.0);
    const pl_vec3 side = pl_vec3_unit(pl_vec3_cross(sun, random_direction(&random)));
    const double off = radius - 0.00465 * far * random_range(&random, -1.5, 3.0);
    const pl_vec3 body = pl_vec3_madd(pl_vec3_madd(here, far, sun), off, side);
    const pl_vec3 radii = {radius, random_range(&random, 0.97, 1.0) * radius, radius};
    stage_add_object(&s, model, here, random_rotation(&random), size);
    stage_add_body(&s, body, radii, 0.3f);
    if (build(&s, &arena, &shot, &view) == PL_OK) {
      shot = culled(&shot, &view, &arena);
      const pl_shot_object *object = &shot.objects[0];
      double most = 0.0;
      for (int k = 0; k < 30; k++) {
        const pl_vec3 place = pl_vec3_madd(object->center, object->radius_m,
                                           k ? random_direction(&random) : (pl_vec3){0, 0, 0});
        const pl_pose pose = {shot.bodies[0].center, PL_QUAT_IDENTITY};
        const double um = 0.0;
        double light;
        uint8_t hides;
        const pl_occultation request = {
            1, 1, 1, shot.sun.radius_m, &place, &shot.sun.position, &pose, &radii, &um, 16};
        const pl_occultation_result out = {&light, &hides};
        assert_int_equal(pl_occultation_solve(&request, &out), PL_OK);
        most = fmax(most, light);
      }
      dark += object->dark;
      lit += !object->dark;
      assert_true(!object->dark || most == 0.0);
      const double inner = 0.97 * radius - object->radius_m;
      const double edge = inner - (0.00466 + 2e-6) * far;
      assert_true(object->dark || fabs(off) > edge);
    }
    stage_clear(&s);
  }
  print_message("%d dark, %d not\n", dark, lit);
  assert_true(dark > 200 && lit > 200);
  pl_arena_clear(&arena);
  pl_model_destroy(model);
}

static void test_camera_inside(void **state) {
  (void)state;
  stage s;
  pl_arena arena;
  pl_snapshot shot;
  pl_arena_init(&arena);
  stage_init(&s, 64, 48, 60.0);
  const size_t body = stage_add_body(&s, (pl_vec3){0, 0, 5}, (pl_vec3){1, 1, 5.001}, 0.5f);
  assert_int_equal(pl_snapshot_build(&s.scene, &s.placement, &arena, &shot), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "body 'body'"));
  s.bodies[body].radii_m.z = 4.999;
  assert_int_equal(pl_snapshot_build(&s.scene, &s.placement, &arena, &shot), PL_OK);
  s.placement.sun.position_m = (pl_vec3){0, 0, -1e8};
  assert_int_equal(pl_snapshot_build(&s.scene, &s.placement, &arena, &shot), PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "sun"));
  stage_clear(&s);
  pl_arena_clear(&arena);
}

/* Every key of a placement, broken in turn. */
static void test_placement_check(void **state) {
  (void)state;
  pl_model *model = cube_create(0.5);
  stage s;
  stage_init(&s, 64, 48, 60.0);
  stage_add_object(&s, model, (pl_vec3){0, 0, 5}, PL_QUAT_IDENTITY, 1.0);
  stage_add_body(&s, (pl_vec3){0, 0, 50}, (pl_vec3){1, 1, 1}, 0.5f);
  assert_int_equal(pl_placement_check(&s.scene, &s.placement), PL_OK);
  double *const keys[] = {
      &s.placement.camera.fx,
      &s.placement.camera.fy,
      &s.placement.camera.cx,
      &s.placement.camera.skew,
      &s.placement.camera.motion.open.t.x,
      &s.placement.camera.motion.close.q.w,
      &s.placement.sun.position_m.y,
      &s.placement.sun.radius_m,
      &s.placement.sun.irradiance_au,
      &s.objects[0].scale,
      &s.objects[0].motion.open.q.x,
      &s.objects[0].motion.close.t.z,
      &s.bodies[0].radii_m.y,
      &s.bodies[0].motion.open.t.y,
  };
  const double bad[] = {NAN, INFINITY, -INFINITY};
  for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
    for (int k = 0; k < 3; k++) {
      const double kept = *keys[i];
      *keys[i] = bad[k];
      assert_int_equal(pl_placement_check(&s.scene, &s.placement), PL_E_RANGE);
      *keys[i] = kept;
    }
  s.bodies[0].albedo[1] = -0.1f;
  assert_int_equal(pl_placement_check(&s.scene, &s.placement), PL_E_RANGE);
  stage_clear(&s);
  pl_model_destroy(model);
}

/* Finite values with which float coordinates overflow. */
static void test_placement_out_of_reach(void **state) {
  (void)state;
  pl_model *model = cube_create(0.5);
  stage s;
  stage_init(&s, 64, 48, 60.0);
  stage_add_object(&s, model, (pl_vec3){0, 0, 5}, PL_QUAT_IDENTITY, 1.0);
  stage_add_body(&s, (pl_vec3){0, 0, 50}, (pl_vec3){1, 1, 1}, 0.5f);
  const struct {
    double *key, value;
    pl_status expected;
  } cases[] = {
      {&s.objects[0].scale, 1e-30, PL_E_RANGE},
      {&s.objects[0].scale, 1e-8, PL_OK},
      {&s.objects[0].scale, 1e19, PL_E_RANGE},
      {&s.objects[0].motion.open.t.x, 1e17, PL_OK},
      {&s.objects[0].motion.open.t.x, 1e18, PL_OK},
      {&s.objects[0].motion.open.t.x, 1.1e18, PL_E_RANGE},
      {&s.placement.camera.motion.open.t.z, -1.1e18, PL_E_RANGE},
      {&s.placement.sun.position_m.y, 1.1e18, PL_E_RANGE},
      {&s.placement.sun.irradiance_au, 1e31, PL_E_RANGE},
      {&s.bodies[0].radii_m.z, 1.1e18, PL_E_RANGE},
      {&s.bodies[0].radii_m.z, 1e-10, PL_E_RANGE},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    const double kept = *cases[i].key;
    *cases[i].key = cases[i].value;
    assert_int_equal(pl_placement_check(&s.scene, &s.placement), cases[i].expected);
    *cases[i].key = kept;
  }
  stage_clear(&s);
  pl_model_destroy(model);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_rebasing_is_exact),
      cmocka_unit_test(test_middle_of_the_exposure),
      cmocka_unit_test(test_in_frame_is_conservative),
      cmocka_unit_test(test_culling_keeps_what_matters),
      cmocka_unit_test(test_culling_keeps_black_screens),
      cmocka_unit_test(test_dark_is_without_sun),
      cmocka_unit_test(test_camera_inside),
      cmocka_unit_test(test_placement_check),
      cmocka_unit_test(test_placement_out_of_reach),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
