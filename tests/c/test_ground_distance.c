/* The distance to the nearest ground: no ground or rock is nearer, and it is not much farther. */
#include "grounds.h"

#include "base/memory.h"
#include "scenes.h"
#include "scene/shutter.h"
#include "terrain/ground_distance.h"
#include "terrain/rock_field.h"

static const double MOON_M = 1737400.0;

static pl_vec3 point_over(const pl_terrain *terrain, pl_vec3 up, double height_m) {
  return pl_vec3_scale(up, pl_terrain_datum_m(terrain, up) + pl_terrain_height(terrain, up, 30) +
                               height_m);
}

/* Distance to the nearest of many points of the ground around the one below. */
static double sampled_m(const pl_terrain *terrain, pl_vec3 eye, double height_m) {
  enum { SIDE = PL_DRAWS(40, 16) };
  const pl_vec3 up = pl_vec3_unit(eye);
  const pl_vec3 east = pl_vec3_unit(pl_vec3_cross((pl_vec3){0.0, 0.0, 1.0}, up));
  const pl_vec3 north = pl_vec3_cross(up, east);
  double nearest = INFINITY;
  for (int i = -SIDE / 2; i <= SIDE / 2; i++)
    for (int j = -SIDE / 2; j <= SIDE / 2; j++) {
      const double x = 4.0 * height_m / MOON_M * i / SIDE, y = 4.0 * height_m / MOON_M * j / SIDE;
      const pl_vec3 to = pl_vec3_unit(pl_vec3_madd(pl_vec3_madd(up, x, east), y, north));
      nearest = fmin(nearest, pl_vec3_norm(pl_vec3_sub(point_over(terrain, to, 0.0), eye)));
    }
  return nearest;
}

static void no_ground_is_nearer(void **state) {
  (void)state;
  static const double heights_m[] = {1.5, 60.0, 3000.0, 2e5};
  for (int rough = 0; rough < 3; rough++) {
    pl_terrain *terrain = ground_rough((pl_vec3){MOON_M, MOON_M, 0.97 * MOON_M}, rough);
    for (int k = 0; k < 4; k++) {
      const pl_vec3 up = pl_vec3_unit((pl_vec3){0.9, 0.35 + 0.1 * k, 0.2});
      const pl_vec3 eye = point_over(terrain, up, heights_m[k]);
      const double clear_m = pl_ground_distance_m(terrain, eye);
      const double nearest_m = sampled_m(terrain, eye, heights_m[k]);
      assert_true(clear_m <= nearest_m);
      assert_true(clear_m >= 0.7 * nearest_m);
    }
    pl_terrain_destroy(terrain);
  }
}

static void no_rock_is_nearer(void **state) {
  (void)state;
  pl_rock_frame frame = pl_rock_frame_default(MOON_M);
  frame.law = (pl_rock_law){.kind = PL_ROCKS_HAWORTH, .factor = 4.0};
  frame.min_m = 0.3;
  pl_rock_field *field;
  assert_int_equal(pl_rock_field_create(&frame, &field), PL_OK);
  pl_terrain_frame body = {.radii_m = {MOON_M, MOON_M, MOON_M},
                           .detail = pl_terrain_detail_default(MOON_M),
                           .rocks = field};
  pl_terrain *terrain;
  assert_int_equal(pl_terrain_create(&body, &terrain), PL_OK);
  int limiting = 0, clear = 0;
  for (int k = 0; k < 12; k++) {
    const pl_vec3 up = pl_vec3_unit((pl_vec3){0.9, 0.35 + 1e-5 * k, 0.2});
    const pl_vec3 eye = point_over(terrain, up, 6.0);
    const double clear_m = pl_ground_distance_m(terrain, eye);
    pl_rock *rocks;
    size_t count;
    assert_int_equal(pl_rock_list(field, terrain, up, 20.0, 0.3, 1e3, &rocks, &count), PL_OK);
    for (size_t i = 0; i < count; i++) {
      const double gap_m =
          pl_vec3_norm(pl_vec3_sub(rocks[i].center, eye)) - 0.5 * rocks[i].diameter_m;
      assert_true(gap_m >= clear_m);
      limiting += gap_m < 5.5;
    }
    clear += clear_m > 2.0;
    pl_free(rocks);
  }
  print_message("%d rocks near, %d places clear\n", limiting, clear);
  assert_true(limiting > 0 && clear > 2);
  pl_terrain_destroy(terrain);
  pl_rock_field_destroy(field);
}

/* Ground that a camera flies over moves as its height says, even below the ellipsoid. */
static void ground_moves_by_its_distance(void **state) {
  (void)state;
  static const double heights_m[] = {2.0, 40.0, 5000.0};
  pl_terrain *terrain = ground_rough((pl_vec3){MOON_M, MOON_M, MOON_M}, 1.0);
  for (int k = 0; k < 3; k++) {
    stage s;
    pl_arena arena;
    pl_snapshot shot;
    pl_view view = {0};
    stage_init(&s, 40, 30, 100.0);
    const pl_vec3 eye = point_over(terrain, (pl_vec3){0.0, 0.0, -1.0}, heights_m[k]);
    stage_add_body(&s, pl_vec3_scale(eye, -1.0), (pl_vec3){MOON_M, MOON_M, MOON_M}, 0.3f);
    s.scene.bodies[0].terrain = terrain;
    s.scene.bodies[0].finest_cell_m = 0.01;
    pl_arena_init(&arena);
    s.placement.camera.motion.close.t.x = 0.02 * heights_m[k];
    s.placement.shutter.exposure_s = 1.0;
    assert_int_equal(pl_snapshot_build(&s.scene, &s.placement, &arena, &shot), PL_OK);
    pl_shutter_measure(&s.placement, &shot, false, &view);
    print_message("%g m: %.2f px\n", heights_m[k], view.blur_px);
    assert_true(view.blur_px > 2.0 && view.blur_px < 4.0); /* 2 straight below */
    pl_arena_clear(&arena);
    stage_clear(&s);
  }
  pl_terrain_destroy(terrain);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(no_ground_is_nearer),
      cmocka_unit_test(no_rock_is_nearer),
      cmocka_unit_test(ground_moves_by_its_distance),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
