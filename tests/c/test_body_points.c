/* Bodies of a tile against the same pixels one by one. */
#include "harness.h"

#include "base/memory.h"
#include "render/body_points.h"
#include "scenes.h"

enum { SIDE = 40, SCENES = 60, BODIES = 4 };

/* Bodies of all sizes before a camera and about it, one behind another, oblate and turned. */
static void fill_stage(stage *s, test_random *random) {
  const pl_vec3 camera = pl_vec3_scale(random_direction(random), 7e8);
  const pl_quat attitude = random_rotation(random);
  stage_init(s, SIDE, SIDE, random_range(random, 10.0, 80.0));
  s->placement.camera.skew = random_range(random, -1.0, 1.0);
  s->placement.camera.motion = still(camera, attitude);
  for (size_t i = 0; i < BODIES; i++) {
    const double size = random_scale(random, 1e2, 1e8);
    const pl_vec3 ahead = pl_vec3_add(random_direction(random), (pl_vec3){0.0, 0.0, 0.8});
    const double distance = size * random_scale(random, 1.01, 20.0); /* never within */
    const pl_vec3 at = pl_quat_rotate(attitude, pl_vec3_scale(pl_vec3_unit(ahead), distance));
    stage_add_body(s, pl_vec3_add(camera, at), (pl_vec3){size, 0.9 * size, 0.5 * size}, 0.5f);
    s->bodies[i].motion.open.q = s->bodies[i].motion.close.q = random_rotation(random);
  }
}

static void assert_same(const pl_snapshot *shot, int x, int y, const pl_vec3 direction,
                        const pl_point *point) {
  const pl_beam beam = {.direction = pl_snapshot_ray(shot, x, y)};
  pl_vertex vertex = {.surface_id = PL_NO_SURFACE};
  assert_memory_equal(&direction, &beam.direction, sizeof direction);
  if (!pl_vertex_meet_bodies(shot, &beam, &vertex)) {
    assert_true(pl_surface_is_none(point->surface_id));
    return;
  }
  pl_vertex_orient(shot, &beam, &vertex);
  assert_int_equal(point->surface_id.value, vertex.surface_id.value);
  assert_int_equal(point->triangle, vertex.triangle);
  assert_memory_equal(&point->position, &vertex.position, sizeof vertex.position);
  assert_memory_equal(&point->t, &vertex.t, sizeof vertex.t);
  assert_memory_equal(point->w, vertex.w, sizeof vertex.w);
  assert_memory_equal(&point->ng, &vertex.ng, sizeof vertex.ng);
  assert_memory_equal(&point->n, &vertex.surface.n, sizeof vertex.surface.n);
  assert_memory_equal(&point->facet, &vertex.surface.ng, sizeof vertex.surface.ng);
}

/* Tiles of a picture, whole and cut by its border; returns how many pixels meet a body. */
static size_t check_tiles(const pl_snapshot *shot) {
  static double directions[3][PL_TILE_PIXELS];
  static pl_point points[PL_TILE_PIXELS];
  size_t met = 0;
  for (int i = 0; i < 4; i++) {
    const int x0 = i % 2 * PL_TILE_SIDE, y0 = i / 2 * PL_TILE_SIDE;
    const int w = SIDE - x0 < PL_TILE_SIDE ? SIDE - x0 : PL_TILE_SIDE;
    const int h = SIDE - y0 < PL_TILE_SIDE ? SIDE - y0 : PL_TILE_SIDE;
    const double rect[4] = {x0 - 0.5, y0 - 0.5, x0 + w - 0.5, y0 + h - 0.5};
    pl_vec3 axis;
    double half_angle;
    pl_snapshot_cone(shot, rect, &axis, &half_angle);
    pl_body_points(shot, (pl_tile){x0, y0, w, h}, axis, half_angle, directions, points);
    for (int y = 0; y < h; y++)
      for (int x = 0; x < w; x++) {
        const int k = y * PL_TILE_SIDE + x;
        const pl_vec3 d = {directions[0][k], directions[1][k], directions[2][k]};
        assert_same(shot, x0 + x, y0 + y, d, &points[k]);
        met += !pl_surface_is_none(points[k].surface_id);
      }
  }
  return met;
}

static void check_scenes(uint64_t seed, const pl_lens *lens) {
  test_random random = {.seed = seed};
  print_message("seed %d\n", (int)seed);
  size_t met = 0;
  for (int i = 0; i < SCENES; i++) {
    stage s;
    pl_arena arena;
    pl_snapshot shot;
    fill_stage(&s, &random);
    s.placement.camera.lens = *lens;
    pl_arena_init(&arena);
    assert_int_equal(pl_snapshot_build(&s.scene, &s.placement, &arena, &shot), PL_OK);
    met += check_tiles(&shot);
    pl_arena_clear(&arena);
    stage_clear(&s);
  }
  const size_t pixels = (size_t)SIDE * SIDE * SCENES;
  print_message("%zu of %zu pixels meet a body\n", met, pixels);
  assert_true(met > pixels / 10 && met < pixels - pixels / 10);
}

static void test_pinhole(void **state) {
  (void)state;
  check_scenes(71, &(pl_lens){.model = NULL});
}

static void test_lens(void **state) {
  (void)state;
  const double coefficients[PL_LENS_COEFFICIENTS] = {-0.02, 0.001};
  pl_lens lens;
  assert_int_equal(pl_lens_init(&pl_lens_models[0], coefficients, &lens), PL_OK);
  check_scenes(72, &lens);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_pinhole),
      cmocka_unit_test(test_lens),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
