/* Visible boxes against brute force; poses against the model's own points. */
#include "harness.h"

#include <stdio.h>

#include "annotate/object_label.h"
#include "scenes.h"

enum { WIDTH = 40, HEIGHT = 30, OBJECTS = 4, SLOTS = 2 * OBJECTS, SIDE = 16 };

/* Whether a surface is that of a slot: of an object, or of body `slot - OBJECTS`. */
static bool is_of_slot(pl_surface_id id, size_t slot, bool bodies) {
  if (!bodies)
    return pl_surface_same(id, pl_surface_make(PL_SURFACE_MESH, slot));
  if (pl_surface_is_none(id))
    return false;
  return pl_surface_index(id) + (pl_surface_is_mesh(id) ? 0 : OBJECTS) == slot;
}

static pl_surface_id random_surface(test_random *random) {
  const int k = random_below(random, 200);
  const size_t index = (size_t)k % OBJECTS;
  return k < OBJECTS - 1 ? pl_surface_make(PL_SURFACE_MESH, (size_t)k)
         : k < 25        ? pl_surface_make(PL_SURFACE_SHAPE, index)
         : k < 50        ? pl_surface_of_body(index)
         : k < 60        ? pl_surface_make(PL_SURFACE_HEIGHT_FIELD, index)
         : k < 70        ? pl_surface_make(PL_SURFACE_ROCKS, index)
                         : PL_NO_SURFACE;
}

/* Random ids in an image; tiles in any order, on any worker, give the box of every object, and of
 * every body with its ground and rocks if bodies count. */
static void test_extents(void **state) {
  (void)state;
  test_random random = {.seed = 71};
  print_message("seed 71\n");
  for (int round = 0; round < 50; round++) {
    static pl_surface_id image[HEIGHT][WIDTH];
    pl_extent workers[3][SLOTS], merged[SLOTS];
    const bool bodies = round % 2 != 0;
    const size_t first_body = bodies ? OBJECTS : PL_EXTENT_NO_BODIES;
    for (int i = 0; i < SLOTS; i++)
      merged[i] = workers[0][i] = workers[1][i] = workers[2][i] = PL_EXTENT_NONE;
    for (int y = 0; y < HEIGHT; y++)
      for (int x = 0; x < WIDTH; x++)
        image[y][x] = random_surface(&random);
    for (int y0 = 0; y0 < HEIGHT; y0 += SIDE)
      for (int x0 = 0; x0 < WIDTH; x0 += SIDE) {
        static pl_point points[SIDE * SIDE];
        const int tile[4] = {x0, y0, WIDTH - x0 < SIDE ? WIDTH - x0 : SIDE,
                             HEIGHT - y0 < SIDE ? HEIGHT - y0 : SIDE};
        for (int i = 0; i < SIDE * SIDE; i++) /* beyond the tile lies rubbish */
          points[i].surface_id = pl_surface_make(PL_SURFACE_MESH, 0);
        for (int y = 0; y < tile[3]; y++)
          for (int x = 0; x < tile[2]; x++)
            points[y * SIDE + x].surface_id = image[y0 + y][x0 + x];
        pl_extent_add(workers[random_below(&random, 3)], first_body, points, SIDE, tile);
      }
    for (int w = 0; w < 3; w++)
      for (int i = 0; i < SLOTS; i++)
        pl_extent_merge(&merged[i], &workers[(w + round) % 3][i]);
    for (size_t i = 0; i < SLOTS; i++) {
      pl_extent expected = PL_EXTENT_NONE;
      for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
          if (is_of_slot(image[y][x], i, bodies)) {
            const pl_extent pixel = {x, y, x, y, 1};
            pl_extent_merge(&expected, &pixel);
          }
      assert_memory_equal(&merged[i], &expected, sizeof expected);
    }
    if (!bodies)
      assert_int_equal(merged[OBJECTS - 1].count, 0);
  }
}

static void test_pose_and_box(void **state) {
  (void)state;
  test_random random = {.seed = 72};
  pl_model *model = cube_create(0.5);
  pl_arena arena;
  pl_arena_init(&arena);
  print_message("seed 72\n");
  for (int i = 0; i < 50; i++) {
    stage s;
    pl_snapshot shot;
    pl_object_label label;
    stage_init(&s, WIDTH, HEIGHT, 50.0);
    const pl_pose camera = {pl_vec3_scale(random_direction(&random), 1e9),
                            random_rotation(&random)};
    const pl_pose object = {pl_vec3_add(camera.t, pl_vec3_scale(random_direction(&random), 100.0)),
                            random_rotation(&random)};
    s.placement.camera.motion = (pl_motion){.open = camera, .close = camera};
    stage_add_object(&s, model, object.t, object.q, 2.0);
    assert_int_equal(pl_snapshot_build(&s.scene, &s.placement, &arena, &shot), PL_OK);
    const pl_extent extent = {3, 4, 10, 4, 8};
    pl_object_label_fill(&shot, 0, &extent, &label);
    const pl_vec3 p = random_direction(&random); /* in the object's frame, m */
    const pl_vec3 q =
        pl_quat_rotate_inverse(camera.q, pl_vec3_sub(pose_apply(object, p), camera.t));
    const double expected[3] = {q.x, q.y, q.z};
    for (int k = 0; k < 3; k++) {
      const double *r = label.R_m2c + 3 * k;
      const double value = r[0] * p.x + r[1] * p.y + r[2] * p.z + label.t_m2c[k];
      assert_true(fabs(value - expected[k]) < 1e-6);
    }
    assert_int_equal(label.obj_id, 1);
    assert_int_equal(label.instance_id, 1);
    assert_int_equal(label.px_count_visib, 8);
    const int32_t box[4] = {3, 4, 7, 0};
    assert_memory_equal(label.bbox_visib, box, sizeof box);
    assert_int_equal(label.in_view, shot.objects[0].in_frame);
    const pl_extent none = PL_EXTENT_NONE;
    pl_object_label_fill(&shot, 0, &none, &label);
    const int32_t unseen[4] = {-1, -1, -1, -1};
    assert_memory_equal(label.bbox_visib, unseen, sizeof unseen);
    stage_clear(&s);
    pl_arena_reset(&arena);
  }
  pl_arena_clear(&arena);
  pl_model_destroy(model);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_extents),
      cmocka_unit_test(test_pose_and_box),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
