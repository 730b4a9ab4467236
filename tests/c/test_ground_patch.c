/* Patches of cells: on a sphere they are the sphere, and where a ray misses them it keeps its point
 * on the triangle. tests/python/terrain_mesh.py makes those of whole scenes again. */
#include "grounds.h"

#include "random.h"
#include "terrain/ground_patch.h"

static const double RADIUS_M = 50000.0;

typedef struct fixture {
  pl_terrain *terrain;
  pl_ground_tile tile;
  const pl_ground_tile *tiles[1];
  pl_height_field field;
} fixture;

static void open_fixture(fixture *f, double strength) {
  f->terrain = ground_rough((pl_vec3){RADIUS_M, RADIUS_M, RADIUS_M}, strength);
  const pl_ground_tile_id id = {.face = 2, .level = 3, .i = 5, .j = 2};
  assert_int_equal(pl_ground_tile_make(f->terrain, id, &f->tile), PL_OK);
  f->tiles[0] = &f->tile;
  f->field = (pl_height_field){
      .terrain = f->terrain, .tiles = f->tiles, .count = 1, .origin = f->tile.origin};
}

/* Embree's coordinates of a place of a cell. */
static float grid(int cell, double in) {
  return (float)((cell + 1 + in) / (PL_GROUND_TILE_SIDE - 1));
}

/* A ray through a place of a triangle, from above; returns the distance of the triangle's plane. */
static double aim(const fixture *f, float u, float v, pl_vec3 aside, pl_vec3 *from,
                  pl_vec3 *along) {
  const pl_vec3 point = pl_height_field_point(&f->field, 0, u, v), up = pl_vec3_unit(point);
  const double away_m = 40.0 * f->tile.cell_m;
  *along = pl_vec3_unit(pl_vec3_madd(pl_vec3_scale(up, -1.0), 1.0, aside));
  *from = pl_vec3_sub(pl_vec3_madd(point, -away_m, *along), f->field.origin);
  return away_m;
}

static double height_m(const fixture *f, pl_vec3 from, pl_vec3 along, double t) {
  return pl_vec3_norm(pl_vec3_add(f->field.origin, pl_vec3_madd(from, t, along))) - RADIUS_M;
}

static void test_a_sphere_is_a_sphere(void **state) {
  (void)state;
  fixture f;
  test_random random = {.seed = 5};
  open_fixture(&f, 0.0);
  double sunk_m = 0.0;
  for (int k = 0; k < 500; k++) {
    const float u = grid(random_below(&random, PL_GROUND_TILE_CELLS), random_unit(&random));
    const float v = grid(random_below(&random, PL_GROUND_TILE_CELLS), random_unit(&random));
    pl_vec3 from, along;
    const double plane =
        aim(&f, u, v, pl_vec3_scale(random_direction(&random), 0.8), &from, &along);
    pl_ground_patch patch;
    pl_ground_patch_at(&f.field, 0, u, v, &patch);
    const double t = pl_ground_patch_meet(&patch, from, along, plane);
    sunk_m = fmax(sunk_m, fabs(height_m(&f, from, along, plane)));
    assert_true(fabs(height_m(&f, from, along, t)) < 2e-5 * f.tile.cell_m);
  }
  assert_true(sunk_m > 1e-3 * f.tile.cell_m); /* chords: a cell squared over 8 radii */
  pl_terrain_destroy(f.terrain);
}

/* On rough ground points move by less than their cell, and those of skirts and of rays along the
 * ground do not. */
static void test_what_is_not_met_stays(void **state) {
  (void)state;
  fixture f;
  test_random random = {.seed = 6};
  open_fixture(&f, 1.0);
  int moved = 0, stayed = 0;
  for (int k = 0; k < 500; k++) {
    const float u = grid(random_below(&random, PL_GROUND_TILE_CELLS), random_unit(&random));
    const float v = grid(random_below(&random, PL_GROUND_TILE_CELLS), random_unit(&random));
    pl_vec3 from, along;
    const double plane = aim(&f, u, v, (pl_vec3){0.0, 0.0, 0.0}, &from, &along);
    pl_ground_patch patch;
    pl_ground_patch_at(&f.field, 0, u, v, &patch);
    const double t = pl_ground_patch_meet(&patch, from, along, plane);
    assert_true(fabs(t - plane) <= patch.cell_m);
    moved += t != plane;
    pl_ground_patch_at(&f.field, 0, grid(-1, 0.5), v, &patch);
    assert_true(pl_ground_patch_meet(&patch, from, along, plane) == plane);
    pl_ground_patch_at(&f.field, 0, u, v, &patch);
    const pl_vec3 flat = pl_vec3_unit(patch.edge1);
    const pl_vec3 over = pl_vec3_madd(patch.corner, patch.cell_m, patch.normal);
    stayed += pl_ground_patch_meet(&patch, over, flat, 0.1) == 0.1;
  }
  assert_true(moved > 490);
  assert_int_equal(stayed, 500);
  pl_terrain_destroy(f.terrain);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_a_sphere_is_a_sphere),
      cmocka_unit_test(test_what_is_not_met_stays),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
