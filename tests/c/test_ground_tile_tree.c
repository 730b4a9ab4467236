/* Choice of tiles: cover, balance, counts against pixels, what is not seen, shadows, the limit. */
#include "grounds.h"

#include <string.h>

#include "terrain/ground_levels.h"
#include "terrain/ground_tile_neighbor.h"

static const double DEGREE = PL_PI / 180.0, MOON_M = 1737400.0;
static const pl_vec3 SOMEWHERE = {0.9, 0.35, 0.2};

typedef struct choice {
  pl_arena arena;
  pl_ground_tile_id *ids;
  size_t count;
  double widened;
  bool patch_missed;
} choice;

static choice choose(const pl_terrain *terrain, const pl_ground_tile_view *view) {
  choice out;
  pl_ground_tile_choice chosen;
  pl_arena_init(&out.arena);
  assert_int_equal(pl_ground_tile_tree_choose(terrain, view, &out.arena, &chosen), PL_OK);
  out.ids = chosen.ids;
  out.count = chosen.count;
  out.widened = chosen.widened;
  out.patch_missed = chosen.patch_missed;
  return out;
}

static bool equal(const choice *a, const choice *b) {
  if (a->count != b->count)
    return false;
  for (size_t k = 0; k < a->count; k++) {
    const pl_ground_tile_id x = a->ids[k], y = b->ids[k];
    if (x.i != y.i || x.j != y.j || x.face != y.face || x.level != y.level || x.coarse != y.coarse)
      return false;
  }
  return true;
}

/* Returns the tile that contains the middle of a place, or of the wider tile around it. */
static const pl_ground_tile_id *find(const choice *in, int level, pl_ground_tile_place place) {
  for (size_t k = 0; k < in->count; k++) {
    const pl_ground_tile_id *id = &in->ids[k];
    const int below = level - id->level;
    if (id->face == place.face && below >= 0 && (int64_t)id->i == place.i >> below &&
        (int64_t)id->j == place.j >> below)
      return id;
  }
  return NULL;
}

static pl_vec3 middle_of(pl_ground_tile_id id) {
  return pl_cube_direction(id.face, pl_cube_node(id.level + 1, 2 * (int64_t)id.i + 1),
                           pl_cube_node(id.level + 1, 2 * (int64_t)id.j + 1));
}

/* Tiles beside each other on all six faces: where they should be in space. */
static void neighbours_touch(void **state) {
  (void)state;
  pl_cube_seams seams;
  pl_cube_seams_find(&seams);
  enum { LEVEL = 4, LAST = (1 << LEVEL) - 1 };
  const double width = 0.5 * PL_PI / (LAST + 1);
  for (int face = 0; face < PL_CUBE_FACES; face++)
    for (int64_t j = 0; j <= LAST; j++)
      for (int64_t i = 0; i <= LAST; i++)
        for (int k = 0; k < 9; k++) {
          const int di = k % 3 - 1, dj = k / 3 - 1;
          pl_ground_tile_place there, back = {0};
          const pl_ground_tile_place here = {face, i, j};
          const bool corner = (i + di < 0 || i + di > LAST) && (j + dj < 0 || j + dj > LAST);
          assert_int_equal(pl_ground_tile_neighbor(&seams, LEVEL, here, di, dj, &there), !corner);
          if (corner || k == 4)
            continue;
          const pl_ground_tile_id a = {
              .face = (uint8_t)face, .level = LEVEL, .i = (uint32_t)i, .j = (uint32_t)j};
          const pl_ground_tile_id b = {.face = (uint8_t)there.face,
                                       .level = LEVEL,
                                       .i = (uint32_t)there.i,
                                       .j = (uint32_t)there.j};
          const double away = pl_vec3_norm(pl_vec3_sub(middle_of(a), middle_of(b)));
          assert_true(away > 0.4 * width && away < 1.75 * width);
          bool mutual = false;
          for (int m = 0; m < 9 && !mutual; m++)
            mutual = pl_ground_tile_neighbor(&seams, LEVEL, there, m % 3 - 1, m / 3 - 1, &back) &&
                     back.face == face && back.i == i && back.j == j;
          assert_true(mutual);
        }
}

/* Every place is covered once, neighbours are balanced, and the bits say which are coarser. */
static void check_tiling(const choice *chosen) {
  static const int beside[8][2] = {{-1, 0},  {1, 0},  {0, -1}, {0, 1},
                                   {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
  static const unsigned touches[8] = {1 | 16 | 64, 2 | 32 | 128, 4 | 16 | 32, 8 | 64 | 128,
                                      16,          32,           64,          128};
  pl_cube_seams seams;
  long double area = 0.0L;
  pl_cube_seams_find(&seams);
  for (size_t k = 0; k < chosen->count; k++) {
    const pl_ground_tile_id id = chosen->ids[k];
    area += ldexpl(1.0L, -2 * id.level);
    unsigned bits = 0;
    for (int n = 0; n < 8; n++) {
      const pl_ground_tile_place own = {id.face, id.i, id.j};
      pl_ground_tile_place place;
      if (!pl_ground_tile_neighbor(&seams, id.level, own, beside[n][0], beside[n][1], &place))
        continue;
      const pl_ground_tile_id *other = find(chosen, id.level, place);
      if (other == NULL)
        continue; /* finer ones are there, which the area shows */
      assert_true(other->level <= id.level && other->level + 1 >= id.level);
      bits |= other->level < id.level ? touches[n] : 0;
    }
    assert_int_equal(bits, id.coarse);
  }
  assert_true(area == 6.0L);
}

static void tiles_cover_the_body_and_are_balanced(void **state) {
  (void)state;
  pl_terrain *terrain = ground_rough((pl_vec3){MOON_M, MOON_M, MOON_M}, 1.0);
  const pl_vec3 spots[] = {SOMEWHERE, {1.0, 1.0, 1.0}, {1.0, -0.999, 0.1}, {0.001, 0.0, -1.0}};
  for (size_t k = 0; k < PL_DRAWS(4, 2); k++) {
    pl_ground_tile_view view =
        ground_view(terrain, spots[k], k == 1 ? 1.5 : 3000.0, 75.0 * DEGREE, 100);
    view.far_casters = k & 1;
    choice chosen = choose(terrain, &view);
    check_tiling(&chosen);
    const choice again = choose(terrain, &view);
    assert_true(equal(&chosen, &again));
    assert_true(chosen.widened == 1.0);
    pl_arena_clear(&chosen.arena);
    pl_arena_clear((pl_arena *)&again.arena);
  }
  pl_terrain_destroy(terrain);
}

/* Looking straight down, a cell of the ground below is a pixel wide, within the rounding of levels,
 * and tiles grow with pixels, not with the height. */
static void cells_follow_pixels(void **state) {
  (void)state;
  pl_terrain *terrain = ground_rough((pl_vec3){MOON_M, MOON_M, MOON_M}, 1.0);
  size_t counts[3];
  for (int k = 0; k < 3; k++) {
    const int pixels = k == 2 ? 1024 : 512;
    const double height_m = k == 0 ? 200e3 : 2e3;
    const pl_ground_tile_view view = ground_view(terrain, SOMEWHERE, height_m, 0.0, pixels);
    choice chosen = choose(terrain, &view);
    const double wanted_m = height_m * view.pixel_rad;
    size_t fine = 0;
    for (size_t n = 0; n < chosen.count; n++) {
      const pl_vec3 d = middle_of(chosen.ids[n]);
      const double cell_m = pl_cube_cell_m(pl_ground_tile_lattice(chosen.ids[n]), MOON_M);
      if (pl_vec3_dot(d, pl_vec3_unit(view.eye)) < cos(0.1 * height_m / MOON_M))
        continue; /* not below */
      assert_true(cell_m < 1.7 * wanted_m && cell_m > 0.6 * wanted_m);
      fine++;
    }
    assert_true(fine > 4);
    counts[k] = chosen.count;
    pl_arena_clear(&chosen.arena);
  }
  print_message("[          ] tiles: %zu of 512^2 from 200 km, %zu from 2 km, %zu of 1024^2\n",
                counts[0], counts[1], counts[2]);
  assert_true(counts[1] < 3 * counts[0] && counts[0] < 3 * counts[1]);
  assert_true(counts[2] < 6 * counts[1] && counts[2] > 2 * counts[1]);
  pl_terrain_destroy(terrain);
}

/* A mast at 1.5 m that looks at the horizon. */
static void grazing_views_need_few_tiles(void **state) {
  (void)state;
  pl_terrain *terrain = ground_rough((pl_vec3){MOON_M, MOON_M, MOON_M}, 1.0);
  const pl_ground_tile_view view = ground_view(terrain, SOMEWHERE, 1.5, 80.0 * DEGREE, 554);
  choice chosen = choose(terrain, &view);
  print_message("[          ] tiles of a mast: %zu\n", chosen.count);
  assert_in_range(chosen.count, 500, 3000);
  pl_arena_clear(&chosen.arena);
  pl_terrain_destroy(terrain);
}

static int level_towards(const choice *chosen, pl_vec3 direction) {
  int face;
  double s, t;
  pl_cube_locate(direction, &face, &s, &t);
  enum { LEVEL = 31 };
  const pl_ground_tile_place place = {face, (int64_t)ldexp(0.5 * (s + 1.0), LEVEL),
                                      (int64_t)ldexp(0.5 * (t + 1.0), LEVEL)};
  const pl_ground_tile_id *id = find(chosen, LEVEL, place);
  assert_non_null(id);
  return id->level;
}

static pl_vec3 beside(pl_vec3 up, double east_m, double north_m) {
  const pl_vec3 east = pl_vec3_unit(pl_vec3_cross((pl_vec3){0.0, 0.0, 1.0}, up));
  const pl_vec3 north = pl_vec3_cross(up, east);
  return pl_vec3_unit(
      pl_vec3_madd(pl_vec3_madd(pl_vec3_scale(up, MOON_M), east_m, east), north_m, north));
}

/* With the sun in the south, what lies to the south of the frame is refined, and less so farther
 * away; nothing to the north. */
static void what_may_shade_the_frame_is_refined(void **state) {
  (void)state;
  pl_terrain *terrain = ground_rough((pl_vec3){MOON_M, MOON_M, MOON_M}, 1.0);
  const pl_vec3 up = pl_vec3_unit(SOMEWHERE);
  pl_ground_tile_view view = ground_view(terrain, SOMEWHERE, 2000.0, 0.0, 256);
  choice without = choose(terrain, &view);
  view.far_casters = true;
  view.to_sun = pl_vec3_unit(pl_vec3_add(pl_vec3_sub(beside(up, 0.0, -1000.0), up),
                                         pl_vec3_scale(up, 0.05 * 1000.0 / MOON_M)));
  choice with = choose(terrain, &view);
  const pl_vec3 south[3] = {beside(up, 0.0, -1600.0), beside(up, 0.0, -5000.0),
                            beside(up, 0.0, -20000.0)};
  int levels[3];
  for (int k = 0; k < 3; k++) {
    levels[k] = level_towards(&with, south[k]);
    assert_true(levels[k] >= level_towards(&without, south[k]) + (k > 0));
    /* The penumbra, or twice the cells that it falls on, within the rounding of levels. */
    const double cell_m = pl_cube_cell_m(levels[k] + PL_GROUND_TILE_SHIFT, MOON_M);
    const double away_m = k == 0 ? 500.0 : k == 1 ? 3900.0 : 18900.0;
    assert_true(cell_m < 1.5 * fmax(away_m * view.sun_diameter_rad, 2.0 * 2000.0 * view.pixel_rad));
  }
  assert_true(levels[0] >= levels[1] && levels[1] >= levels[2]);
  const pl_vec3 north = beside(up, 0.0, 20000.0);
  assert_int_equal(level_towards(&with, north), level_towards(&without, north));
  /* At night nothing shades anything. */
  view.to_sun = pl_vec3_scale(up, -1.0);
  choice night = choose(terrain, &view);
  assert_true(equal(&night, &without));
  pl_arena_clear(&without.arena);
  pl_arena_clear(&with.arena);
  pl_arena_clear(&night.arena);
  pl_terrain_destroy(terrain);
}

static void unseen_ground_is_coarse(void **state) {
  (void)state;
  pl_terrain *terrain = ground_rough((pl_vec3){MOON_M, MOON_M, MOON_M}, 1.0);
  const pl_vec3 up = pl_vec3_unit(SOMEWHERE);
  pl_ground_tile_view view = ground_view(terrain, SOMEWHERE, 2000.0, 0.0, 512);
  choice down = choose(terrain, &view);
  const int level = level_towards(&down, up);
  assert_true(level_towards(&down, beside(up, 0.0, 30e3)) < level - 3);
  assert_true(level_towards(&down, pl_vec3_scale(up, -1.0)) <= 3);
  /* All directions but those into the sky are in this frame. */
  view.half_angle_rad = PL_PI;
  view.side_count = 0;
  choice all = choose(terrain, &view);
  assert_true(level_towards(&all, beside(up, 0.0, 30e3)) >= level - 5);
  assert_true(all.count > down.count);
  pl_arena_clear(&down.arena);
  pl_arena_clear(&all.arena);
  pl_terrain_destroy(terrain);
}

static void limits_are_kept(void **state) {
  (void)state;
  pl_terrain *terrain = ground_rough((pl_vec3){MOON_M, MOON_M, MOON_M}, 1.0);
  pl_ground_tile_view view = ground_view(terrain, SOMEWHERE, 10.0, 60.0 * DEGREE, 256);
  view.finest_m = 0.04;
  choice free = choose(terrain, &view);
  for (size_t k = 0; k < free.count; k++)
    assert_true(pl_cube_cell_m(pl_ground_tile_lattice(free.ids[k]), MOON_M) >= 0.04);
  const size_t limits[] = {free.count, free.count - 1, free.count / 2, 100, 6, 0};
  double before = 1.0;
  for (size_t k = 0; k < sizeof limits / sizeof *limits; k++) {
    view.limit = limits[k];
    choice chosen = choose(terrain, &view);
    assert_true(chosen.count <= (limits[k] < 6 ? 6 : limits[k]));
    assert_true(k == 0 ? chosen.widened == 1.0 && equal(&chosen, &free) : chosen.widened > 1.0);
    assert_true(chosen.widened >= before);
    check_tiling(&chosen);
    before = chosen.widened;
    pl_arena_clear(&chosen.arena);
  }
  pl_arena_clear(&free.arena);
  pl_terrain_destroy(terrain);
}

static int finest_of(const choice *chosen) {
  int most = 0;
  for (size_t k = 0; k < chosen->count; k++) {
    const int level = pl_ground_tile_lattice(chosen->ids[k]);
    most = level > most ? level : most;
  }
  return most;
}

/* The levels that a plan counts bound those of the tiles, and closely where the nearest ground is
 * in the frame; with a lower bound tiles keep it, and are the same up to there. */
static void levels_are_bounded(void **state) {
  (void)state;
  static const double heights_m[] = {1.5, 60.0, 3e3, 2e5, 8e6};
  for (int k = 0; k < PL_DRAWS(15, 5); k++) {
    const double size_m = k % 3 == 1 ? 1e3 : MOON_M, tilt = k % 2 == 0 ? 0.0 : 70.0 * DEGREE;
    pl_terrain *terrain = ground_rough((pl_vec3){size_m, size_m, 0.97 * size_m}, k / 5);
    pl_ground_tile_view view =
        ground_view(terrain, SOMEWHERE, heights_m[k % 5] * size_m / MOON_M, tilt, 128 << (k % 2));
    view.cells_per_pixel = k % 4 == 3 ? 0.5 : 1.0;
    view.far_casters = true;
    view.finest_m = 1e-4;
    choice chosen = choose(terrain, &view);
    const int levels = pl_ground_levels(terrain, &view), finest = finest_of(&chosen);
    assert_true(finest <= levels);
    assert_true(tilt > 0.0 || levels <= finest + 2);
    view.finest_level = levels;
    const choice same = choose(terrain, &view);
    assert_true(equal(&chosen, &same));
    view.finest_level = finest - 3;
    const choice coarse = choose(terrain, &view);
    assert_int_equal(finest_of(&coarse),
                     finest - 3 > PL_GROUND_TILE_SHIFT ? finest - 3 : PL_GROUND_TILE_SHIFT);
    check_tiling(&coarse);
    pl_arena_clear(&chosen.arena);
    pl_arena_clear((pl_arena *)&same.arena);
    pl_arena_clear((pl_arena *)&coarse.arena);
    pl_terrain_destroy(terrain);
  }
}

/* A body of 1 km, one of 71 000 km, one that is oblate, and one that is a few pixels wide. */
static void bodies_of_all_sizes(void **state) {
  (void)state;
  const pl_vec3 radii[] = {{1e3, 1e3, 1e3}, {71e6, 71e6, 66e6}, {900.0, 700.0, 400.0}};
  for (int k = 0; k < 3; k++) {
    pl_terrain *terrain = ground_rough(radii[k], 1.0);
    pl_ground_tile_view view = ground_view(terrain, SOMEWHERE, 3.0, 70.0 * DEGREE, 128);
    choice near = choose(terrain, &view);
    check_tiling(&near);
    view = ground_view(terrain, SOMEWHERE, 300.0 * radii[k].x, 0.0, 128);
    choice far = choose(terrain, &view);
    assert_in_range(far.count, 6, 24);
    assert_in_range(near.count, 100, 3000);
    pl_arena_clear(&near.arena);
    pl_arena_clear(&far.arena);
    pl_terrain_destroy(terrain);
  }
}

static void bad_views_are_refused(void **state) {
  (void)state;
  pl_terrain *terrain = ground_rough((pl_vec3){1e3, 1e3, 1e3}, 1.0);
  const pl_ground_tile_view good = ground_view(terrain, SOMEWHERE, 3.0, 0.0, 128);
  pl_ground_tile_view bad[6];
  for (int k = 0; k < 6; k++)
    bad[k] = good;
  bad[0].pixel_rad = 0.0;
  bad[1].cells_per_pixel = NAN;
  bad[2].finest_m = -1.0;
  bad[3].eye = (pl_vec3){0.0, 0.0, 0.0};
  bad[4].limit = SIZE_MAX;
  bad[5].far_casters = true;
  bad[5].to_sun.x = INFINITY;
  pl_arena arena;
  pl_arena_init(&arena);
  for (int k = 0; k < 6; k++) {
    pl_ground_tile_choice chosen;
    assert_int_equal(pl_ground_tile_tree_choose(terrain, &bad[k], &arena, &chosen), PL_E_RANGE);
  }
  pl_arena_clear(&arena);
  pl_terrain_destroy(terrain);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(neighbours_touch),
      cmocka_unit_test(tiles_cover_the_body_and_are_balanced),
      cmocka_unit_test(cells_follow_pixels),
      cmocka_unit_test(levels_are_bounded),
      cmocka_unit_test(grazing_views_need_few_tiles),
      cmocka_unit_test(what_may_shade_the_frame_is_refined),
      cmocka_unit_test(unseen_ground_is_coarse),
      cmocka_unit_test(limits_are_kept),
      cmocka_unit_test(bodies_of_all_sizes),
      cmocka_unit_test(bad_views_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
