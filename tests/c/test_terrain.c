/* Heights: posts to the bit, blocks against points, edges of the cube, layers, bounds, errors. */
#include "harness.h"

#include <math.h>
#include <string.h>

#include "random.h"
#include "terrain/terrain.h"

static const double DEGREE = PL_PI / 180.0, RADIUS_M = 1737400.0;

enum { SIDE = 40 };
typedef struct ground {
  float samples[SIDE * SIDE];
  int16_t whole[36 * 18];
  pl_raster *patch, *body;
} ground;

/* A patch of 40 x 40 posts, 20 m apart, over a model of the body in steps of 10 degrees. */
static void setup(ground *g, uint64_t seed) {
  test_random random = {.seed = seed};
  for (int k = 0; k < SIDE * SIDE; k++)
    g->samples[k] = (float)random_range(&random, -10.0, 10.0);
  for (int k = 0; k < 36 * 18; k++)
    g->whole[k] = (int16_t)random_range(&random, -3000.0, 3000.0);
  const pl_raster_frame patch = {
      .samples = g->samples,
      .type = PL_RASTER_FLOAT32,
      .width = SIDE,
      .height = SIDE,
      .scale = 1.0,
      .projection = {.kind = PL_PROJECTION_ORTHOGRAPHIC,
                     .lon0_rad = 3.6 * DEGREE,
                     .lat0_rad = 26.0 * DEGREE,
                     .radius_m = RADIUS_M},
      .x0 = -390.0,
      .y0 = 390.0,
      .dx = 20.0,
      .dy = -20.0,
  };
  const pl_raster_frame body = {
      .samples = g->whole,
      .type = PL_RASTER_INT16,
      .width = 36,
      .height = 18,
      .scale = 0.5,
      .x0 = 5.0 * DEGREE,
      .y0 = 85.0 * DEGREE,
      .dx = 10.0 * DEGREE,
      .dy = -10.0 * DEGREE,
  };
  assert_int_equal(pl_raster_create(&patch, &g->patch), PL_OK);
  assert_int_equal(pl_raster_create(&body, &g->body), PL_OK);
}

static void teardown(ground *g) {
  pl_raster_destroy(g->patch);
  pl_raster_destroy(g->body);
}

static pl_terrain *make_by(const ground *g, size_t layers, pl_raster_interpolation how, bool detail,
                           pl_detail_method method) {
  const pl_terrain_layer given[2] = {{g->body, how, 0.0, 0.0}, {g->patch, how, 4.0, 0.0}};
  pl_terrain_frame frame = {
      .radii_m = {RADIUS_M, RADIUS_M, RADIUS_M},
      .layers = given,
      .layer_count = layers,
      .detail = pl_terrain_detail_default(RADIUS_M),
  };
  frame.detail.on = detail;
  frame.detail.method = method;
  pl_terrain *terrain;
  assert_int_equal(pl_terrain_create(&frame, &terrain), PL_OK);
  return terrain;
}

static pl_terrain *make(const ground *g, size_t layers, pl_raster_interpolation how, bool detail) {
  return make_by(g, layers, how, detail, PL_DETAIL_NOISE);
}

static void test_posts(void **state) {
  (void)state;
  enum { EVERY = PL_DRAWS(1, 5) };
  static ground g;
  setup(&g, 1);
  for (int k = 0; k < PL_INTERPOLATION_COUNT * PL_DETAIL_METHOD_COUNT; k++) {
    const pl_raster_interpolation how = (pl_raster_interpolation)(k % PL_INTERPOLATION_COUNT);
    pl_terrain *terrain = make_by(&g, 2, how, true, (pl_detail_method)(k / PL_INTERPOLATION_COUNT));
    int moved = 0;
    for (int row = 5; row < SIDE - 5; row += EVERY)
      for (int column = 5; column < SIDE - 5; column++) {
        const double z = (double)g.samples[row * SIDE + column];
        const pl_vec3 d = pl_raster_direction(g.patch, column, row);
        assert_true(pl_terrain_height(terrain, d, 17 + column % 12) == z);
        const pl_vec3 beside = pl_raster_direction(g.patch, column + 0.3, row + 0.6);
        double u, v;
        assert_true(pl_raster_find(g.patch, beside, &u, &v));
        moved += fabs(pl_terrain_height(terrain, beside, 28) -
                      pl_raster_value(g.patch, 0, u, v, how)) > 0.05;
      }
    assert_true(moved > 700 / EVERY); /* of 900: detail is there */
    pl_terrain_destroy(terrain);
  }
  teardown(&g);
}

/* Blocks across the patch, of any size and place, have the bits of points. */
static void check_blocks(pl_detail_method method) {
  static ground g;
  setup(&g, 2);
  pl_terrain *terrain = make_by(&g, 2, PL_INTERPOLATION_CUBIC, true, method);
  test_random random = {.seed = 3};
  int face;
  double s, t;
  pl_cube_locate(pl_raster_direction(g.patch, 20.0, 20.0), &face, &s, &t);
  for (int level = 3; level <= 29; level += PL_DRAWS(1, 5)) {
    enum { LARGE = 100, SMALL = 23 };
    static double large[LARGE * LARGE], small[SMALL * SMALL];
    static pl_vec3 directions[SMALL * SMALL];
    const int64_t half = (int64_t)1 << (level - 1);
    const int64_t i = half + (int64_t)floor(s * (double)half),
                  j = half + (int64_t)floor(t * (double)half);
    const pl_terrain_nodes whole = {face, level, i - 60, j - 30, LARGE, LARGE};
    assert_int_equal(pl_terrain_block(terrain, &whole, large, NULL), PL_OK);
    for (int k = 0; k < PL_DRAWS(4, 1); k++) {
      const int di = random_below(&random, LARGE - SMALL),
                dj = random_below(&random, LARGE - SMALL);
      const pl_terrain_nodes part = {face, level, whole.i0 + di, whole.j0 + dj, SMALL, SMALL};
      assert_int_equal(pl_terrain_block(terrain, &part, small, directions), PL_OK);
      for (int row = 0; row < SMALL; row++)
        assert_memory_equal(&small[row * SMALL], &large[(row + dj) * LARGE + di],
                            SMALL * sizeof(double));
      const int node = random_below(&random, SMALL * SMALL);
      const pl_vec3 d = pl_cube_direction(face, pl_cube_node(level, part.i0 + node % SMALL),
                                          pl_cube_node(level, part.j0 + node / SMALL));
      assert_memory_equal(&d, &directions[node], sizeof d);
      assert_true(pl_terrain_height(terrain, d, level) == small[node]);
    }
  }
  pl_terrain_destroy(terrain);
  teardown(&g);
}

static void test_blocks(void **state) {
  (void)state;
  check_blocks(PL_DETAIL_NOISE);
  check_blocks(PL_DETAIL_DIAMOND_SQUARE);
}

/* An edge of the cube: the same bits from both faces. */
static void test_edges_of_the_cube(void **state) {
  (void)state;
  static ground g;
  setup(&g, 4);
  for (size_t layers = 0; layers < 2; layers++) {
    pl_terrain *terrain = make(&g, layers, PL_INTERPOLATION_BILINEAR, true);
    for (int level = 6; level < 30; level += 7) {
      double a[33], b[33];
      const int64_t last = (int64_t)1 << level, from = last / 3;
      pl_terrain_block(terrain, &(pl_terrain_nodes){0, level, last, from, 1, 33}, a, NULL);
      pl_terrain_block(terrain, &(pl_terrain_nodes){2, level, 0, from, 1, 33}, b, NULL);
      assert_memory_equal(a, b, sizeof a);
      pl_terrain_block(terrain, &(pl_terrain_nodes){0, level, from, last, 33, 1}, a, NULL);
      pl_terrain_block(terrain, &(pl_terrain_nodes){4, level, from, last, 33, 1}, b, NULL);
      assert_true(a[0] != a[1]);
    }
    pl_terrain_destroy(terrain);
  }
  teardown(&g);
}

/* Where borders are blended, heights go over from one layer to the other without a step. */
static void test_border(void **state) {
  (void)state;
  static ground g;
  setup(&g, 5);
  pl_terrain *both = make(&g, 2, PL_INTERPOLATION_CUBIC, true);
  pl_terrain *below = make(&g, 1, PL_INTERPOLATION_CUBIC, true);
  const int level = 20;
  double last = NAN;
  for (int k = 0; k <= 1000; k++) {
    const double u = -2.0 + 8.0 * k / 1000.0;
    const pl_vec3 d = pl_raster_direction(g.patch, u, 20.3);
    const double h = pl_terrain_height(both, d, level);
    if (u < -0.5)
      assert_true(h == pl_terrain_height(below, d, level));
    /* 0.16 m on: slopes of the blend are up to thousands of m in 80 m */
    assert_true(k == 0 || fabs(h - last) < 20.0);
    last = h;
  }
  pl_terrain_destroy(both);
  pl_terrain_destroy(below);
  teardown(&g);
}

static void test_datum(void **state) {
  (void)state;
  static ground g;
  setup(&g, 6);
  const pl_terrain_layer layer = {g.body, PL_INTERPOLATION_BILINEAR, 0.0, RADIUS_M};
  const pl_terrain_frame frame = {
      .radii_m = {RADIUS_M, RADIUS_M, RADIUS_M - 2000.0}, .layers = &layer, .layer_count = 1};
  pl_terrain *terrain;
  assert_int_equal(pl_terrain_create(&frame, &terrain), PL_OK);
  test_random random = {.seed = 7};
  double low_m, high_m;
  pl_terrain_bounds(terrain, &low_m, &high_m);
  for (int k = 0; k < 200; k++) {
    const pl_vec3 d = random_direction(&random);
    double u, v;
    assert_true(pl_raster_find(g.body, d, &u, &v));
    const double h = pl_terrain_height(terrain, d, 20);
    const double z = pl_raster_value(g.body, 0, u, v, PL_INTERPOLATION_BILINEAR);
    assert_true(fabs(pl_terrain_datum_m(terrain, d) + h - (RADIUS_M + z)) < 1e-8);
    assert_true(h >= low_m && h <= high_m);
  }
  pl_terrain_destroy(terrain);
  teardown(&g);
}

static void test_bounds(void **state) {
  (void)state;
  static ground g;
  setup(&g, 8);
  for (size_t layers = 0; layers < 3; layers++) {
    pl_terrain *terrain = make(&g, layers, PL_INTERPOLATION_CUBIC, true);
    test_random random = {.seed = 9};
    double low_m, high_m;
    pl_terrain_bounds(terrain, &low_m, &high_m);
    assert_true(isfinite(low_m) && isfinite(high_m) && low_m < high_m);
    for (int k = 0; k < PL_DRAWS(3000, 300); k++) {
      const double h = pl_terrain_height(terrain, random_direction(&random),
                                         random_below(&random, PL_CUBE_LEVELS));
      assert_true(h >= low_m && h <= high_m);
    }
    pl_terrain_destroy(terrain);
  }
  teardown(&g);
}

static void test_levels(void **state) {
  (void)state;
  static ground g;
  setup(&g, 10);
  pl_terrain *terrain = make(&g, 2, PL_INTERPOLATION_CUBIC, true);
  assert_true(pl_terrain_radius_m(terrain) == RADIUS_M);
  const int finest = pl_terrain_finest_level(terrain);
  assert_int_equal(finest, pl_terrain_level_of(terrain, 0.01));
  assert_true(pl_terrain_relief_m(terrain, finest) == 0.0);
  for (int level = 0; level < finest; level++)
    assert_true(pl_terrain_relief_m(terrain, level) > pl_terrain_relief_m(terrain, level + 1) ||
                level < 1); /* octaves begin at level 2 */
  const pl_vec3 d = pl_vec3_unit((pl_vec3){1.0, -2.0, 0.3});
  /* The same octaves, of which other ones are summed in double. */
  assert_true(fabs(pl_terrain_height(terrain, d, finest) -
                   pl_terrain_height(terrain, d, finest + 3)) < 1e-6);
  pl_terrain_destroy(terrain);
  pl_terrain *bare = make(&g, 2, PL_INTERPOLATION_CUBIC, false);
  assert_int_equal(pl_terrain_finest_level(bare), pl_terrain_level_of(bare, 10.0));
  pl_terrain_destroy(bare);
  teardown(&g);
}

static void expect_refused(pl_terrain_frame frame, pl_status status) {
  pl_terrain *terrain;
  assert_int_equal(pl_terrain_create(&frame, &terrain), status);
  assert_null(terrain);
}

/* Craters: over all, below 6 posts of the patch only where it is; blocks have the bits of points.
 */
static void test_craters(void **state) {
  (void)state;
  static ground g;
  setup(&g, 12);
  pl_crater_frame settings = pl_crater_frame_default(RADIUS_M);
  pl_crater_field *craters;
  settings.min_m = 20.0;
  settings.max_m = 3000.0;
  assert_int_equal(pl_crater_field_create(&settings, &craters), PL_OK);
  const pl_terrain_layer layer = {g.patch, PL_INTERPOLATION_CUBIC, 4.0, 0.0};
  pl_terrain_frame frame = {.radii_m = {RADIUS_M, RADIUS_M, RADIUS_M},
                            .layers = &layer,
                            .layer_count = 1,
                            .craters = craters};
  pl_terrain *with, *without;
  assert_int_equal(pl_terrain_create(&frame, &with), PL_OK);
  frame.craters = NULL;
  assert_int_equal(pl_terrain_create(&frame, &without), PL_OK);
  const int level = pl_terrain_level_of(with, 5.0);
  double most_in = 0.0, most_out = 0.0;
  for (int k = 0; k < PL_DRAWS(300, 60); k++) {
    const double step = k % 2 == 0 ? 12.0 + k % 16 : 4000.0 + 10.0 * k;
    const pl_vec3 d = pl_raster_direction(g.patch, step, 8.0 + (k / 2) % 20);
    const double relief_m =
        pl_terrain_height(with, d, level) - pl_terrain_height(without, d, level);
    assert_true(pl_terrain_base_height(with, d, level) == pl_terrain_height(without, d, level));
    double *most = k % 2 == 0 ? &most_in : &most_out;
    *most = fmax(*most, fabs(relief_m));
  }
  assert_true(most_in > 0.2 && most_in < 40.0); /* craters of up to 120 m */
  assert_true(most_out > 0.5);
  double block[48 * 40], low_m, high_m;
  pl_vec3 directions[48 * 40];
  pl_terrain_bounds(with, &low_m, &high_m);
  const pl_terrain_nodes nodes = {0,  level, (int64_t)1 << (level - 1), (int64_t)1 << (level - 2),
                                  48, 40};
  assert_int_equal(pl_terrain_block(with, &nodes, block, directions), PL_OK);
  for (int k = 0; k < 48 * 40; k += PL_DRAWS(53, 401)) {
    assert_true(pl_terrain_height(with, directions[k], level) == block[k]);
    assert_true(block[k] >= low_m && block[k] <= high_m);
  }
  frame.craters = craters;
  frame.radii_m.x *= 2.0;
  expect_refused(frame, PL_E_RANGE);
  pl_terrain_destroy(with);
  pl_terrain_destroy(without);
  pl_crater_field_destroy(craters);
  teardown(&g);
}

/* Of many patches, each over half of the one before it, heights in a direction are those of the
 * few that reach there, to the bit; also where more fade into each other than at most places. */
static void test_many_patches(void **state) {
  (void)state;
  enum { PATCHES = 200, TRIES = PL_DRAWS(300, 60) };
  static ground g;
  static pl_terrain_layer layers[PATCHES + 1];
  test_random random = {.seed = 12};
  setup(&g, 3);
  pl_raster_frame frame = *pl_raster_frame_of(g.patch);
  layers[0] = (pl_terrain_layer){g.body, PL_INTERPOLATION_CUBIC, 0.0, 0.0};
  for (int n = 0; n < PATCHES; n++) {
    pl_raster *raster;
    const double side_m = SIDE * frame.dx;
    frame.x0 = -390.0 + (n < 20 ? n : 0.5 * n * side_m / 20.0);
    frame.y0 = 390.0 + 5.0 * (n < 20 ? n : n % 7);
    frame.offset = n;
    assert_int_equal(pl_raster_create(&frame, &raster), PL_OK);
    layers[n + 1] = (pl_terrain_layer){raster, PL_INTERPOLATION_CUBIC, 20.0, 0.0};
  }
  pl_terrain_frame all = {.radii_m = {RADIUS_M, RADIUS_M, RADIUS_M},
                          .layers = layers,
                          .layer_count = PATCHES + 1,
                          .detail = pl_terrain_detail_default(RADIUS_M)};
  pl_terrain *terrain;
  assert_int_equal(pl_terrain_create(&all, &terrain), PL_OK);
  int reaching = 0, crowded = 0;
  for (int k = 0; k < TRIES; k++) {
    static pl_terrain_layer few[PATCHES + 1];
    double u, v;
    const pl_vec3 d = k < TRIES / 2
                          ? pl_raster_direction(g.patch, random_range(&random, -5.0, 120.0),
                                                random_range(&random, -5.0, SIDE + 5.0))
                          : pl_raster_direction(g.patch, random_range(&random, 0.0, 2.0), SIDE / 2);
    size_t count = 0;
    for (int n = 0; n <= PATCHES; n++)
      if (pl_raster_find(layers[n].raster, d, &u, &v)) {
        assert_false(pl_raster_far(layers[n].raster, d, 0.0));
        few[count++] = layers[n];
      }
    reaching += count > 1;
    crowded += count > 16;
    pl_terrain_frame some = all;
    pl_terrain *alone;
    some.layers = few;
    some.layer_count = count;
    assert_int_equal(pl_terrain_create(&some, &alone), PL_OK);
    assert_true(pl_terrain_height(terrain, d, 24) == pl_terrain_height(alone, d, 24));
    pl_terrain_destroy(alone);
  }
  assert_true(reaching > TRIES / 2 && crowded > TRIES / 3);
  pl_terrain_destroy(terrain);
  for (int n = 0; n < PATCHES; n++)
    pl_raster_destroy((pl_raster *)layers[n + 1].raster);
  teardown(&g);
}

/* A patch 100 m above the body's model, and tilted: with an apron the ground meets its edges all
 * around; posts stay, far ground has the same bits, slopes are small, bounds hold. */
static void test_apron(void **state) {
  (void)state;
  static ground g;
  setup(&g, 4);
  pl_raster_frame frame = *pl_raster_frame_of(g.patch);
  static float tilted[SIDE * SIDE];
  for (int k = 0; k < SIDE * SIDE; k++)
    tilted[k] = (float)(100.0 + 0.5 * (k % SIDE) - 1.5 * (double)(k / SIDE)) + 0.02F * g.samples[k];
  frame.samples = tilted;
  pl_raster *patch;
  assert_int_equal(pl_raster_create(&frame, &patch), PL_OK);
  const pl_terrain_layer layers[2] = {{g.body, PL_INTERPOLATION_CUBIC, 0.0, 0.0},
                                      {patch, PL_INTERPOLATION_CUBIC, 4.0, 0.0}};
  const double aprons_m[2] = {0.0, 500.0};
  pl_terrain_frame given = {
      .radii_m = {RADIUS_M, RADIUS_M, RADIUS_M}, .layers = layers, .layer_count = 2};
  pl_terrain *with, *without;
  assert_int_equal(pl_terrain_create(&given, &without), PL_OK);
  given.aprons_m = aprons_m;
  assert_int_equal(pl_terrain_create(&given, &with), PL_OK);
  double low_m, high_m, steepest = 0.0, wall = 0.0;
  pl_terrain_bounds(with, &low_m, &high_m);
  for (int way = 0; way < 24; way++) { /* from the middle outwards, in all directions */
    const double x = cos(way * PL_PI / 12.0), y = sin(way * PL_PI / 12.0);
    double before[2] = {(double)NAN, (double)NAN};
    for (double out = 0.0; out < 60.0; out += 0.05) {
      const double u = 19.5 + out * x, v = 19.5 + out * y,
                   beside = fmax(fabs(out * x), fabs(out * y));
      const pl_vec3 d = pl_raster_direction(patch, u, v);
      const double h = pl_terrain_height(with, d, 24), plain = pl_terrain_height(without, d, 24);
      assert_true(h >= low_m && h <= high_m);
      if (beside < 15.9 ||
          hypot(fmax(fabs(out * x) - 20.0, 0.0), fmax(fabs(out * y) - 20.0, 0.0)) > 25.001)
        assert_true(h == plain);
      if (beside > 19.0 && beside < 21.0)
        assert_true(fabs(h - (100.0 + 0.5 * fmin(fmax(u, 0.0), 39.0) -
                              1.5 * fmin(fmax(v, 0.0), 39.0))) < 4.0);
      steepest = fmax(steepest, fabs(h - before[0]));
      wall = fmax(wall, fabs(plain - before[1]));
      before[0] = h;
      before[1] = plain;
    }
  }
  assert_true(steepest < 0.5 && wall > 2.0); /* a metre a step */
  pl_terrain_destroy(with);
  pl_terrain_destroy(without);
  pl_raster_destroy(patch);
  teardown(&g);
}

static void test_refusals(void **state) {
  (void)state;
  static ground g;
  setup(&g, 11);
  const pl_terrain_layer good = {g.body, PL_INTERPOLATION_BILINEAR, 0.0, 0.0};
  const pl_terrain_frame frame = {.radii_m = {1e6, 1e6, 1e6},
                                  .layers = &good,
                                  .layer_count = 1,
                                  .detail = pl_terrain_detail_default(1e6)};
  pl_terrain_frame bad = frame;
  bad.radii_m.y = 0.0;
  expect_refused(bad, PL_E_RANGE);
  bad.radii_m.y = (double)NAN;
  expect_refused(bad, PL_E_RANGE);
  bad = frame;
  bad.layer_count = PL_TERRAIN_LAYERS + 1;
  expect_refused(bad, PL_E_RANGE);
  pl_terrain_layer layer = good;
  bad = frame;
  bad.layers = &layer;
  layer.raster = NULL;
  expect_refused(bad, PL_E_ARGUMENT);
  double apron_m = (double)NAN;
  bad = frame;
  bad.aprons_m = &apron_m;
  expect_refused(bad, PL_E_RANGE);
  apron_m = 100.0; /* of a raster that goes around the body */
  expect_refused(bad, PL_E_RANGE);
  bad = frame;
  bad.layers = &layer;
  layer = good;
  layer.border_posts = -1.0;
  expect_refused(bad, PL_E_RANGE);
  layer = good;
  layer.datum_m = (double)INFINITY;
  expect_refused(bad, PL_E_RANGE);
  teardown(&g);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_posts),
      cmocka_unit_test(test_blocks),
      cmocka_unit_test(test_edges_of_the_cube),
      cmocka_unit_test(test_border),
      cmocka_unit_test(test_datum),
      cmocka_unit_test(test_bounds),
      cmocka_unit_test(test_levels),
      cmocka_unit_test(test_craters),
      cmocka_unit_test(test_many_patches),
      cmocka_unit_test(test_apron),
      cmocka_unit_test(test_refusals),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
