/* Pixels that a mesh fills against rays: in none of them does a ray meet another instance than the
 * one through the centre, or nothing. */
#include "annotate/filled_pixel.h"

#include "render/geometry.h"
#include "scenes.h"
#include "trace/tracer.h"

enum { WIDTH = 80, HEIGHT = 56, TRIES = 16, ROWS = 12, COLUMNS = 18 };

/* From the centre: as far as pl_image_sample_offset goes. */
static const double FARTHEST = 0.542;

/* Pixels: those that see a mesh, those that it fills. */
typedef struct sums {
  int seen, filled;
} sums;

/* What a tile is checked with. */
typedef struct check {
  const pl_snapshot *shot;
  const pl_tracer *tracer;
  const pl_fill *fill;
  test_random *random;
  sums *sums;
} check;

static void trace(const check *c, const double (*places)[2], pl_hit *hits, size_t count) {
  pl_ray rays[TRIES];
  for (size_t i = 0; i < count; i++)
    rays[i] = (pl_ray){.t_max = INFINITY,
                       .direction = pl_snapshot_ray(c->shot, places[i][0], places[i][1]),
                       .skip_body = PL_NO_BODY};
  pl_tracer_closest(c->tracer, rays, hits, count, true, true);
}

static void check_pixel(const check *c, int x, int y) {
  pl_hit hits[TRIES], centre;
  double places[TRIES][2];
  trace(c, (const double[][2]){{x, y}}, &centre, 1);
  if (pl_surface_is_none(centre.surface_id) || !pl_surface_is_mesh(centre.surface_id))
    return;
  c->sums->seen++;
  if (!pl_fill_has(c->fill, centre.surface_id, centre.triangle, x, y))
    return;
  c->sums->filled++;
  for (int i = 0; i < TRIES; i++) {
    places[i][0] = x + random_range(c->random, -FARTHEST, FARTHEST);
    places[i][1] = y + random_range(c->random, -FARTHEST, FARTHEST);
  }
  trace(c, (const double(*)[2])places, hits, TRIES);
  for (int i = 0; i < TRIES; i++)
    if (!pl_surface_same(hits[i].surface_id, centre.surface_id))
      fail_msg("a ray through (%g, %g) passes the mesh that fills pixel (%d, %d)", places[i][0],
               places[i][1], x, y);
}

static void check_stage(const stage *stage, test_random *random, sums *sums) {
  pl_arena arena;
  pl_snapshot shot;
  pl_accelerators *kept;
  const pl_tracer *tracer;
  pl_adjacency_cache cache;
  const pl_adjacency *adjacencies[STAGE_THINGS];
  pl_fill fill;
  pl_arena_init(&arena);
  pl_adjacency_cache_init(&cache);
  assert_int_equal(pl_accelerators_create(&kept), PL_OK);
  assert_int_equal(pl_snapshot_build(&stage->scene, &stage->placement, &arena, &shot), PL_OK);
  assert_int_equal(pl_geometry_tracer(kept, &shot, &arena, &tracer), PL_OK);
  for (size_t i = 0; i < shot.object_count; i++)
    assert_int_equal(pl_adjacency_cache_get(&cache, shot.objects[i].object->model, &adjacencies[i]),
                     PL_OK);
  const check c = {&shot, tracer, &fill, random, sums};
  for (int y0 = 0; y0 < HEIGHT; y0 += PL_TILE_SIDE)
    for (int x0 = 0; x0 < WIDTH; x0 += PL_TILE_SIDE) {
      const pl_tile tile = {x0, y0, WIDTH - x0 < PL_TILE_SIDE ? WIDTH - x0 : PL_TILE_SIDE,
                            HEIGHT - y0 < PL_TILE_SIDE ? HEIGHT - y0 : PL_TILE_SIDE};
      pl_fill_begin(&shot, adjacencies, tile, &fill);
      for (int y = y0; y < y0 + tile.height; y++)
        for (int x = x0; x < x0 + tile.width; x++)
          check_pixel(&c, x, y);
    }
  pl_adjacency_cache_clear(&cache);
  pl_accelerators_destroy(kept);
  pl_arena_clear(&arena);
}

/* A closed surface of meridians and parallels with bumps, of vertices of its own in each face, as
 * files have them. */
static pl_model *ball_create(test_random *random, double bumps) {
  pl_model *model = model_create(4 * ROWS * COLUMNS, 2 * ROWS * COLUMNS);
  pl_vec3 points[ROWS + 1][COLUMNS];
  for (int i = 0; i <= ROWS; i++)
    for (int k = 0; k < COLUMNS; k++) {
      const double polar = PL_PI * i / ROWS, turn = 2.0 * PL_PI * k / COLUMNS;
      const double radius = i > 0 && i < ROWS ? 1.0 + bumps * random_range(random, -1.0, 1.0) : 1.0;
      points[i][k] =
          (pl_vec3){radius * sin(polar) * cos(turn) * (i > 0 && i < ROWS),
                    radius * sin(polar) * sin(turn) * (i > 0 && i < ROWS), radius * cos(polar)};
    }
  for (uint32_t face = 0; face < ROWS * COLUMNS; face++) {
    const uint32_t i = face / COLUMNS, k = face % COLUMNS, next = (k + 1) % COLUMNS, v = 4 * face;
    const uint32_t order[6] = {v, v + 1, v + 2, v, v + 2, v + 3};
    model_set_vertex(model, v, points[i][k], points[i][k]);
    model_set_vertex(model, v + 1, points[i + 1][k], points[i + 1][k]);
    model_set_vertex(model, v + 2, points[i + 1][next], points[i + 1][next]);
    model_set_vertex(model, v + 3, points[i][next], points[i][next]);
    memcpy(model->indices + 6 * face, order, sizeof order);
  }
  pl_model_measure(model);
  return model;
}

/* Turns the winding of some triangles, and takes others away. */
static void damage(pl_model *model, test_random *random, double turned, double lost) {
  for (size_t t = 0; t < model->triangle_count; t++) {
    uint32_t *corner = model->indices + 3 * t;
    if (random_range(random, 0.0, 1.0) < turned) {
      const uint32_t swap = corner[1];
      corner[1] = corner[2];
      corner[2] = swap;
    }
    if (random_range(random, 0.0, 1.0) < lost)
      corner[1] = corner[2] = corner[0];
  }
}

/* What a world is made of. */
typedef struct world {
  double bumps, turned, lost;
  bool one_sided;
  double low_m, high_m; /* distance */
  int objects, bodies;
  double apart; /* of objects, radii */
} world;

static sums check_worlds(int count, const world *w, uint64_t seed) {
  test_random random = {.seed = seed};
  sums sums = {0};
  for (int i = 0; i < count; i++) {
    stage stage;
    pl_model *model = ball_create(&random, w->bumps);
    damage(model, &random, w->turned, w->lost);
    model->materials[0].double_sided = !w->one_sided;
    const double away = random_scale(&random, w->low_m, w->high_m);
    stage_init(&stage, WIDTH, HEIGHT, fmax(away, 1.0) * random_range(&random, 10.0, 40.0));
    for (int k = 0; k < w->objects; k++)
      stage_add_object(&stage, model,
                       (pl_vec3){random_range(&random, -0.5, 0.5), random_range(&random, -0.5, 0.5),
                                 away + k * w->apart},
                       random_rotation(&random), 1.0);
    for (int k = 0; k < w->bodies; k++)
      stage_add_body(&stage, (pl_vec3){random_range(&random, -1.0, 1.0), 0.3, away + 3.0 * k - 1.0},
                     (pl_vec3){0.6, 0.5, 0.4}, 0.5f);
    check_stage(&stage, &random, &sums);
    stage_clear(&stage);
    pl_model_destroy(model);
  }
  print_message("%d of %d pixels of meshes are known to be filled\n", sums.filled, sums.seen);
  assert_true(sums.seen > 0);
  return sums;
}

static void test_round(void **state) {
  (void)state;
  const sums sums = check_worlds(4, &(world){.low_m = 5.0, .high_m = 50.0, .objects = 1}, 1);
  assert_true(sums.filled > 0.7 * sums.seen);
}

/* Bumps of half the radius hide each other, and fold. */
static void test_folds(void **state) {
  (void)state;
  const sums sums =
      check_worlds(6, &(world){.bumps = 0.5, .low_m = 3.0, .high_m = 50.0, .objects = 1}, 2);
  assert_true(sums.filled > 0.1 * sums.seen && sums.filled < sums.seen);
}

/* Triangles that are wound the other way, or missing; of single-sided ones rays meet no backs. */
static void test_damage(void **state) {
  (void)state;
  world w = {.turned = 0.2, .lost = 0.1, .low_m = 3.0, .high_m = 50.0, .objects = 1};
  const sums both = check_worlds(6, &w, 3);
  w.one_sided = true;
  const sums one = check_worlds(6, &w, 3);
  assert_true(both.filled > 0 && one.filled > 0 && one.filled < both.filled);
}

/* Objects that go through each other and behind each other, and bodies among them. */
static void test_others(void **state) {
  (void)state;
  world w = {.bumps = 0.1, .low_m = 5.0, .high_m = 20.0, .objects = 3, .apart = 0.7};
  assert_int_equal(check_worlds(4, &w, 4).filled, 0);
  w.apart = 4.0;
  assert_true(check_worlds(4, &w, 5).filled > 0);
  w.bodies = 3;
  w.objects = 2;
  check_worlds(6, &w, 6);
}

/* Rounding of a mesh that is seen from a million of its radii, and from within. */
static void test_extremes(void **state) {
  (void)state;
  const sums far =
      check_worlds(4, &(world){.bumps = 0.2, .low_m = 1e6, .high_m = 1e8, .objects = 1}, 7);
  assert_true(far.filled > 0);
  check_worlds(6, &(world){.bumps = 0.5, .low_m = 0.05, .high_m = 0.9, .objects = 1}, 8);
}

/* Three faces at an edge, an edge of a triangle without area, and faces that share none. */
static void test_edges(void **state) {
  (void)state;
  pl_model *model = model_create(6, 4);
  const pl_vec3 up = {0, 0, 1};
  const pl_vec3 places[6] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, -0.0, 0}};
  const uint32_t order[12] = {0, 1, 2, 1, 5, 3, 0, 1, 4, 2, 2, 1};
  pl_adjacency found;
  for (size_t v = 0; v < 6; v++)
    model_set_vertex(model, v, places[v], up);
  memcpy(model->indices, order, sizeof order);
  model->triangle_count = 2;
  assert_int_equal(pl_adjacency_init(model, &found), PL_OK);
  assert_int_equal(found.across[0], 3);
  assert_int_equal(found.across[3], 0);
  for (int half = 1; half < 6; half++)
    assert_true(half == 3 || found.across[half] >= PL_NO_NEIGHBOUR);
  pl_adjacency_clear(&found);
  model->triangle_count = 4;
  assert_int_equal(pl_adjacency_init(model, &found), PL_OK);
  assert_true(found.across[0] >= PL_NO_NEIGHBOUR && found.across[3] >= PL_NO_NEIGHBOUR &&
              found.across[6] >= PL_NO_NEIGHBOUR);
  pl_adjacency_clear(&found);
  pl_model_destroy(model);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      serial_unit_test(test_round),  serial_unit_test(test_folds),    serial_unit_test(test_damage),
      serial_unit_test(test_others), serial_unit_test(test_extremes), serial_unit_test(test_edges),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
