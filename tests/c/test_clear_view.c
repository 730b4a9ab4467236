/* Rays that are spared against rays that are cast: what nothing may hide, nothing hides. */
#include "annotate/clear_view.h"

#include "geom/ellipsoid.h"
#include "render/geometry.h"
#include "scenes.h"

enum { WIDTH = 96, HEIGHT = 64, WORLDS = 40, ROW = 64 };

typedef struct sums {
  size_t hidden, spared, all;
} sums;

/* Distance to a body along a ray from the camera; infinite if it is missed. */
static double distance_to(const pl_shot_body *body, pl_vec3 direction) {
  double t;
  const pl_vec3 along = pl_mat3_mul_vec(body->to_unit, direction);
  return pl_unit_sphere_intersect(body->camera_unit, along, 0.0, &t) ? t : INFINITY;
}

static bool any_before(const pl_snapshot *shot, pl_vec3 direction, size_t but, double distance_m) {
  for (size_t i = 0; i < shot->body_count; i++)
    if (i != but && distance_to(&shot->bodies[i], direction) < distance_m)
      return true;
  return false;
}

/* A sight on the ray through a pixel: on a body that it meets, on none, or a direction. */
static pl_sight sight_at(const pl_snapshot *shot, test_random *random, pl_sight_query *query) {
  const size_t index = (size_t)random_range(random, 0.0, (double)shot->body_count + 2.0);
  const pl_sight direction = pl_sight_towards(query->ray.direction);
  query->distance_m = random_scale(random, 1.0, 1e4);
  if (index > shot->body_count)
    return direction;
  if (index == shot->body_count)
    return (pl_sight){.is_point = true, .surface_id = pl_surface_make(PL_SURFACE_MESH, 0)};
  query->distance_m = distance_to(&shot->bodies[index], query->ray.direction);
  if (isinf(query->distance_m))
    return direction;
  return (pl_sight){.is_point = true, .surface_id = pl_surface_of_body(index), .index = index};
}

/* The rays of a row of pixels at once. */
static void check_row(const pl_snapshot *shot, test_random *random, int y, sums *sums) {
  pl_sight_query queries[ROW];
  pl_sight sights[ROW];
  pl_bodies_near near;
  const double step = random_scale(random, 0.01, 1.0);
  for (int x = 0; x < ROW; x++) {
    queries[x].ray = (pl_ray){.direction = pl_snapshot_ray(shot, 16.0 + step * x, y)};
    sights[x] = sight_at(shot, random, &queries[x]);
  }
  pl_bodies_near_find(shot, queries, ROW, &near);
  for (int x = 0; x < ROW; x++) {
    const pl_sight *s = &sights[x];
    const bool own = s->is_point && pl_surface_is_ellipsoid(s->surface_id);
    const double far_m = s->is_point ? queries[x].distance_m : INFINITY;
    const bool may = pl_bodies_near_hide(shot, &near, s, &queries[x]);
    const bool hidden =
        any_before(shot, queries[x].ray.direction, own ? s->index : SIZE_MAX, far_m);
    assert_true(may || !hidden);
    sums->hidden += hidden;
    sums->spared += !may;
    sums->all++;
  }
}

static void add_bodies(stage *stage, test_random *random, int count) {
  for (int i = 0; i < count; i++) {
    const double away = random_scale(random, 3.0, 3e3), part = random_scale(random, 1e-2, 0.5);
    const pl_vec3 toward = {random_range(random, -0.8, 0.8), random_range(random, -0.6, 0.6), 1.0};
    const pl_vec3 radii = {part * away, part * away * random_range(random, 0.5, 1.0), part * away};
    stage_add_body(stage, pl_vec3_scale(pl_vec3_unit(toward), away), radii, 0.5f);
  }
}

static void check_worlds(int bodies, sums *sums) {
  test_random random = {.seed = (uint64_t)bodies};
  for (int i = 0; i < WORLDS; i++) {
    stage stage;
    pl_arena arena;
    pl_snapshot shot;
    pl_arena_init(&arena);
    stage_init(&stage, WIDTH, HEIGHT, random_range(&random, 10.0, 80.0));
    add_bodies(&stage, &random, bodies);
    assert_int_equal(pl_snapshot_build(&stage.scene, &stage.placement, &arena, &shot), PL_OK);
    for (int y = 0; y < HEIGHT; y++)
      check_row(&shot, &random, y, sums);
    pl_arena_clear(&arena);
    stage_clear(&stage);
  }
  assert_true(sums->hidden > 0);
}

static void test_bodies(void **state) {
  (void)state;
  sums one = {0}, some = {0}, many = {0};
  check_worlds(1, &one);
  check_worlds(4, &some);
  check_worlds(PL_BODIES_NEAR + 6, &many); /* more than are listed */
  assert_true(one.spared > one.all / 2);
  assert_true(some.spared > some.all / 4);
}

static void test_meshes(void **state) {
  (void)state;
  test_random random = {.seed = 9};
  pl_model *cube = cube_create(0.5);
  stage stage;
  pl_arena arena;
  pl_snapshot shot;
  pl_accelerators *kept;
  const pl_tracer *tracer;
  pl_coverage meshes = {0};
  pl_arena_init(&arena);
  stage_init(&stage, WIDTH, HEIGHT, 40.0);
  stage_add_object(&stage, cube, (pl_vec3){1.0, -0.5, 9.0}, random_rotation(&random), 3.0);
  assert_int_equal(pl_accelerators_create(&kept), PL_OK);
  assert_int_equal(pl_snapshot_build(&stage.scene, &stage.placement, &arena, &shot), PL_OK);
  assert_int_equal(pl_geometry_tracer(kept, &shot, &arena, &tracer), PL_OK);
  assert_int_equal(pl_coverage_update(&meshes, &shot, 0, HEIGHT, 1, 1), PL_OK);
  const pl_sight_frame frame = {.shot = &shot, .tracer = tracer, .meshes = &meshes};
  const pl_sight_frame rows = {.shot = &shot, .tracer = tracer, .meshes = &meshes, .rows = true};
  const pl_sight_frame blind = {.shot = &shot, .tracer = tracer};
  size_t hits = 0, spared = 0;
  for (int i = 0; i < 20000; i++) {
    const double pixel[2] = {random_range(&random, -0.5, WIDTH - 0.5),
                             random_range(&random, -0.5, HEIGHT - 0.5)};
    const pl_ray ray = {.t_max = INFINITY,
                        .direction = pl_snapshot_ray(&shot, pixel[0], pixel[1]),
                        .skip_body = PL_NO_BODY};
    pl_hit hit;
    pl_tracer_closest(tracer, &ray, &hit, 1, false, true);
    const bool may = pl_sight_may_meet_mesh(&frame, pixel);
    assert_true(may || pl_surface_is_none(hit.surface_id));
    assert_true(pl_sight_may_meet_mesh(&rows, pixel) && pl_sight_may_meet_mesh(&blind, pixel));
    hits += !pl_surface_is_none(hit.surface_id);
    spared += !may;
  }
  assert_true(hits > 1000 && spared > 10000);
  pl_coverage_clear(&meshes);
  pl_accelerators_destroy(kept);
  pl_arena_clear(&arena);
  stage_clear(&stage);
  pl_model_destroy(cube);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_bodies),
      cmocka_unit_test(test_meshes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
