/* Tiles: posts on the height function, shared with neighbours to the bit, slopes, bounds. */
#include "grounds.h"

#include <stdlib.h>
#include <string.h>

#include "random.h"
#include "terrain/cube.h"
#include "terrain/height_field.h"

static const double DEGREE = PL_PI / 180.0, MOON_M = 1737400.0;

enum { SIDE = PL_GROUND_TILE_SIDE, POSTS = PL_GROUND_TILE_POSTS, CELLS = PL_GROUND_TILE_CELLS };

static pl_vec3 post_of(const pl_ground_tile *tile, int i, int j) {
  const float *p = tile->positions[(j + 1) * SIDE + i + 1];
  return pl_vec3_add(tile->origin, (pl_vec3){p[0], p[1], p[2]});
}

static pl_vec3 node_of(pl_ground_tile_id id, int i, int j) {
  const int level = pl_ground_tile_lattice(id);
  return pl_cube_direction(id.face, pl_cube_node(level, (int64_t)id.i * CELLS + i),
                           pl_cube_node(level, (int64_t)id.j * CELLS + j));
}

static void posts_lie_on_the_height_function(void **state) {
  (void)state;
  const pl_vec3 radii[] = {{MOON_M, MOON_M, MOON_M}, {71.5e6, 71.5e6, 66.9e6}, {500, 400, 300}};
  test_random random = {.seed = 41};
  pl_ground_tile *tile = malloc(sizeof *tile);
  for (int k = 0; k < PL_DRAWS(60, 12); k++) {
    pl_terrain *terrain = ground_rough(radii[k % 3], 1.0 + k % 2);
    const int level = random_below(&random, k % 3 == 2 ? 8 : 23);
    const pl_ground_tile_id id = {.face = (uint8_t)random_below(&random, 6),
                                  .level = (uint8_t)level,
                                  .i = (uint32_t)random_below(&random, 1 << level),
                                  .j = (uint32_t)random_below(&random, 1 << level)};
    assert_int_equal(pl_ground_tile_make(terrain, id, tile), PL_OK);
    for (int n = 0; n < 40; n++) {
      const int i = random_below(&random, POSTS), j = random_below(&random, POSTS);
      const pl_vec3 p = post_of(tile, i, j), d = node_of(id, i, j);
      const double height = pl_terrain_height(terrain, d, pl_ground_tile_lattice(id));
      const pl_vec3 exact = pl_vec3_scale(d, pl_terrain_datum_m(terrain, d) + height);
      assert_true(pl_vec3_norm(pl_vec3_sub(p, exact)) < 1e-5 * tile->cell_m);
      assert_true(height >= (double)tile->low_m * (1.0 + (tile->low_m < 0.0f ? 1e-6 : -1e-6)) &&
                  height <= (double)tile->high_m * (1.0 + (tile->high_m < 0.0f ? -1e-6 : 1e-6)));
    }
    for (int n = 0; n < SIDE * SIDE; n++) {
      const float *p = tile->positions[n];
      assert_true(sqrt((double)p[0] * p[0] + (double)p[1] * p[1] + (double)p[2] * p[2]) <=
                  tile->radius_m);
      const pl_vec3 p3 = pl_vec3_add(tile->origin, (pl_vec3){p[0], p[1], p[2]});
      assert_true(pl_vec3_norm(p3) <= tile->most_m);
    }
    pl_terrain_destroy(terrain);
  }
  free(tile);
}

/* --- seams ------------------------------------------------------------------------------------ */

typedef struct edge_post {
  pl_vec3 p;
  double cell_m;
  size_t tile;
  bool middle; /* between two posts of a coarser neighbour */
  bool on_cube_edge;
  pl_vec3 normal;
} edge_post;

static int by_x(const void *a, const void *b) {
  const edge_post *x = a, *y = b;
  return x->p.x < y->p.x ? -1 : x->p.x > y->p.x;
}

static bool on_cube_edge(pl_ground_tile_id id, int i, int j) {
  const int64_t last = (int64_t)CELLS << id.level;
  const int64_t x = (int64_t)id.i * CELLS + i, y = (int64_t)id.j * CELLS + j;
  return x == 0 || y == 0 || x == last || y == last;
}

static pl_vec3 normal_of(const pl_ground_tile *tile, int i, int j) {
  const pl_height_field field = {.tiles = &tile, .count = 1, .origin = tile->origin};
  return pl_height_field_normal(&field, 0, (float)(i + 1) / (SIDE - 1),
                                (float)(j + 1) / (SIDE - 1));
}

static size_t add_edge(const pl_ground_tile *tile, size_t index, int side, edge_post *out) {
  const bool coarse = tile->id.coarse >> side & 1;
  for (int n = 0; n < POSTS; n++) {
    const int i = side < 2 ? (side & 1) * CELLS : n, j = side < 2 ? n : (side & 1) * CELLS;
    out[n] =
        (edge_post){post_of(tile, i, j),          tile->cell_m,         index, coarse && n % 2 == 1,
                    on_cube_edge(tile->id, i, j), normal_of(tile, i, j)};
    if (out[n].middle)
      continue;
    /* Posts between two of a coarser edge are in their middle, exactly. */
    if (coarse && n >= 2) {
      const pl_vec3 middle = pl_vec3_scale(pl_vec3_add(out[n - 2].p, out[n].p), 0.5);
      assert_memory_equal(&middle, &out[n - 1].p, sizeof middle);
    }
  }
  return POSTS;
}

/* Makes the tiles of a frame and compares what they share. */
static void check_seams(const pl_terrain *terrain, const pl_ground_tile_view *view) {
  pl_arena arena;
  pl_ground_tile_choice chosen;
  size_t posts = 0, stitched = 0;
  pl_arena_init(&arena);
  assert_int_equal(pl_ground_tile_tree_choose(terrain, view, &arena, &chosen), PL_OK);
  const pl_ground_tile_id *ids = chosen.ids;
  const size_t count = chosen.count;
  edge_post *edge = malloc(count * 4 * POSTS * sizeof *edge);
  pl_ground_tile *tile = malloc(sizeof *tile);
  for (size_t k = 0; k < count; k++) {
    assert_int_equal(pl_ground_tile_make(terrain, ids[k], tile), PL_OK);
    stitched += ids[k].coarse != 0;
    for (int side = 0; side < 4; side++)
      posts += add_edge(tile, k, side, edge + posts);
  }
  assert_true(stitched > 10);
  qsort(edge, posts, sizeof *edge, by_x);
  for (size_t a = 0; a < posts; a++) {
    const edge_post *post = &edge[a];
    const double near_m = 2e-5 * post->cell_m;
    double nearest = INFINITY, turn = INFINITY;
    if (post->middle)
      continue;
    size_t from = a;
    while (from > 0 && edge[from - 1].p.x >= post->p.x - near_m)
      from--;
    for (size_t b = from; b < posts && edge[b].p.x <= post->p.x + near_m; b++) {
      if (edge[b].tile == post->tile)
        continue;
      const double away = pl_vec3_norm(pl_vec3_sub(edge[b].p, post->p));
      if (away <= nearest) {
        nearest = away;
        turn = fmin(turn, pl_vec3_norm(pl_vec3_sub(edge[b].normal, post->normal)));
      }
    }
    assert_true(nearest == 0.0);
    assert_true(turn < (post->on_cube_edge ? 0.5 : 1e-3));
  }
  free(edge);
  free(tile);
  pl_arena_clear(&arena);
}

static void neighbours_share_posts_to_the_bit(void **state) {
  (void)state;
  const pl_vec3 spots[] = {{0.9, 0.35, 0.2}, {1.0, 1.0, 1.0}, {-1.0, 0.3, -0.999}};
  for (int k = 0; k < 3; k++) {
    const double radius_m = k == 1 ? 5000.0 : MOON_M;
    pl_terrain *terrain = ground_rough((pl_vec3){radius_m, radius_m, 0.9 * radius_m}, 2.0);
    pl_ground_tile_view view =
        ground_view(terrain, spots[k], k == 0 ? 2.0 : 200.0, 70.0 * DEGREE, PL_DRAWS(64, 16));
    view.half_angle_rad = PL_PI; /* on all sides */
    view.side_count = 0;
    view.finest_m = 0.1;
    check_seams(terrain, &view);
    pl_terrain_destroy(terrain);
  }
}

/* --- normals ---------------------------------------------------------------------------------- */

/* On an ellipsoid without heights, normals between posts are the ellipsoid's, within the square of
 * a cell's angle. */
static void normals_of_an_ellipsoid(void **state) {
  (void)state;
  const pl_vec3 radii = {3000.0, 2800.0, 2500.0};
  pl_terrain *terrain = ground_rough(radii, 0.0);
  test_random random = {.seed = 3};
  pl_ground_tile *tile = malloc(sizeof *tile);
  for (int n = 0; n < 200; n++) {
    const int level = n % 3;
    const pl_ground_tile_id id = {.face = (uint8_t)(n % 6),
                                  .level = (uint8_t)level,
                                  .i = (uint32_t)random_below(&random, 1 << level),
                                  .j = (uint32_t)random_below(&random, 1 << level)};
    const pl_ground_tile *tiles[1] = {tile};
    const pl_height_field field = {.tiles = tiles, .count = 1, .origin = {10.0, 20.0, 30.0}};
    if (n % 20 == 0)
      assert_int_equal(pl_ground_tile_make(terrain, id, tile), PL_OK);
    const float u = (float)random_range(&random, 0.03, 0.97);
    const float v = (float)random_range(&random, 0.03, 0.97);
    const pl_vec3 p = pl_height_field_point(&field, 0, u, v);
    const pl_vec3 exact = pl_vec3_unit(
        (pl_vec3){p.x / (radii.x * radii.x), p.y / (radii.y * radii.y), p.z / (radii.z * radii.z)});
    const double angle = ldexp(0.5 * PL_PI, -pl_ground_tile_lattice(tile->id));
    const pl_vec3 smooth = pl_height_field_normal(&field, 0, u, v);
    const pl_vec3 facet = ground_facet_normal(&field, 0, u, v);
    assert_true(pl_vec3_norm(pl_vec3_sub(smooth, exact)) < 0.3 * angle * angle + 2e-5);
    assert_true(pl_vec3_norm(pl_vec3_sub(facet, exact)) < 1.5 * angle);
  }
  free(tile);
  pl_terrain_destroy(terrain);
}

/* On rough ground, normals at posts are those of the facets around them, on average. */
static void normals_follow_the_facets(void **state) {
  (void)state;
  pl_terrain *terrain = ground_rough((pl_vec3){MOON_M, MOON_M, MOON_M}, 1.0);
  const pl_ground_tile_id id = {.face = 4, .level = 15, .i = 12345, .j = 23456};
  pl_ground_tile *tile = malloc(sizeof *tile);
  assert_int_equal(pl_ground_tile_make(terrain, id, tile), PL_OK);
  const pl_height_field field = {.tiles = (const pl_ground_tile *const[]){tile}, .count = 1};
  double smooth_slope = 0.0;
  for (int j = 1; j < CELLS; j++)
    for (int i = 1; i < CELLS; i++) {
      pl_vec3 mean = {0.0, 0.0, 0.0};
      for (int k = 0; k < 8; k++) { /* two facets in each of four cells */
        const double x = i + 1 + (k & 1 ? 0.3 : -0.7) + (k & 4 ? 0.2 : 0.3);
        const double y = j + 1 + (k & 2 ? 0.3 : -0.7) + (k & 4 ? 0.3 : 0.2) + (k & 4 ? 0.2 : -0.2);
        mean = pl_vec3_add(
            mean, ground_facet_normal(&field, 0, (float)(x / (SIDE - 1)), (float)(y / (SIDE - 1))));
      }
      mean = pl_vec3_unit(mean);
      const pl_vec3 normal = normal_of(tile, i, j), up = pl_vec3_unit(post_of(tile, i, j));
      assert_true(pl_vec3_norm(pl_vec3_sub(normal, mean)) < 0.1);
      smooth_slope += pl_vec3_norm(pl_vec3_cross(normal, up)) / ((CELLS - 1) * (CELLS - 1));
    }
  assert_true(smooth_slope > 0.03); /* it is rough */
  free(tile);
  pl_terrain_destroy(terrain);
}

/* A body without relief has no slopes at all: normals are exactly radial. */
static void a_flat_body_has_no_slopes(void **state) {
  (void)state;
  pl_terrain *terrain = ground_rough((pl_vec3){MOON_M, MOON_M, MOON_M}, 0.0);
  pl_ground_tile *tile = malloc(sizeof *tile);
  for (int level = 0; level < 20; level += 5) {
    const pl_ground_tile_id id = {.face = 2, .level = (uint8_t)level, .i = 0, .j = 0};
    assert_int_equal(pl_ground_tile_make(terrain, id, tile), PL_OK);
    for (int j = 0; j < POSTS; j += 4)
      for (int i = 0; i < POSTS; i += 4)
        assert_true(pl_vec3_norm(pl_vec3_sub(normal_of(tile, i, j), node_of(id, i, j))) < 2e-6);
  }
  assert_true(sizeof *tile < 20000);
  free(tile);
  pl_terrain_destroy(terrain);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(posts_lie_on_the_height_function),
      cmocka_unit_test(neighbours_share_posts_to_the_bit),
      cmocka_unit_test(normals_of_an_ellipsoid),
      cmocka_unit_test(normals_follow_the_facets),
      cmocka_unit_test(a_flat_body_has_no_slopes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
