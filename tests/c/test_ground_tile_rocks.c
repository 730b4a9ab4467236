/* Rocks of tiles: closed meshes of the right size, the same rocks at any level of detail. */
#include "harness.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "terrain/ground_tile_rocks.h"

static const double RADIUS_M = 1737400.0;

typedef struct world {
  pl_terrain *terrain;
  pl_rock_field *rocks;
} world;

static world make(double factor, double min_m, double max_m) {
  const pl_terrain_frame ground = {.radii_m = {RADIUS_M, RADIUS_M, RADIUS_M},
                                   .detail = pl_terrain_detail_default(RADIUS_M)};
  pl_rock_frame frame = pl_rock_frame_default(RADIUS_M);
  frame.law = (pl_rock_law){.kind = PL_ROCKS_HAWORTH, .factor = factor};
  frame.min_m = min_m;
  frame.max_m = max_m;
  frame.seed = 4;
  world world;
  assert_int_equal(pl_terrain_create(&ground, &world.terrain), PL_OK);
  assert_int_equal(pl_rock_field_create(&frame, &world.rocks), PL_OK);
  return world;
}

static void clear(world *world) {
  pl_rock_field_destroy(world->rocks);
  pl_terrain_destroy(world->terrain);
}

static pl_ground_rocks *rocks_of(const world *world, pl_ground_tile_id id, pl_vec3 *origin) {
  *origin = pl_vec3_scale(pl_cube_direction(id.face, ldexp(id.i + 0.5, 1 - id.level) - 1.0,
                                            ldexp(id.j + 0.5, 1 - id.level) - 1.0),
                          RADIUS_M);
  pl_ground_rocks *rocks;
  assert_int_equal(pl_ground_rocks_make(world->rocks, world->terrain, id, *origin, &rocks), PL_OK);
  return rocks;
}

/* Volume and the sum of the normals' areas of a rock's triangles, which vanishes for a closed mesh.
 */
static double volume_of(const pl_ground_rocks *rocks, size_t k, pl_vec3 *open) {
  double volume = 0.0;
  *open = (pl_vec3){0.0, 0.0, 0.0};
  const float *zero = rocks->positions[rocks->triangles[rocks->first[k]][0]];
  for (uint32_t t = rocks->first[k]; t < rocks->first[k + 1]; t++) {
    pl_vec3 p[3];
    for (int c = 0; c < 3; c++) {
      const float *at = rocks->positions[rocks->triangles[t][c]];
      p[c] = (pl_vec3){(double)at[0] - (double)zero[0], (double)at[1] - (double)zero[1],
                       (double)at[2] - (double)zero[2]};
    }
    const pl_vec3 n = pl_vec3_cross(pl_vec3_sub(p[1], p[0]), pl_vec3_sub(p[2], p[0]));
    *open = pl_vec3_add(*open, n);
    volume += pl_vec3_dot(p[0], n) / 6.0;
  }
  return volume;
}

static void check_mesh(const pl_ground_rocks *rocks, pl_vec3 origin) {
  for (size_t k = 0; k < rocks->count; k++) {
    const pl_rock *rock = &rocks->rocks[k];
    const double d = rock->diameter_m;
    pl_vec3 open;
    const double volume = volume_of(rocks, k, &open);
    /* An ellipsoid of axes 1, 1 and 0.6 has 0.31. */
    if (!(volume > 0.05 * d * d * d && volume < 0.75 * d * d * d))
      fail_msg("rock of %g m, family %d: volume %g", d, (int)rock->family, volume);
    assert_true(pl_vec3_norm(open) < 1e-3 * d * d);
    for (uint32_t t = rocks->first[k]; t < rocks->first[k + 1]; t++) {
      assert_int_equal(pl_ground_rocks_of(rocks, t), k);
      for (int c = 0; c < 3; c++) {
        const uint32_t v = rocks->triangles[t][c];
        assert_true(v < rocks->vertex_count);
        const float *at = rocks->positions[v], *n = rocks->normals[v];
        const pl_vec3 from =
            pl_vec3_sub(pl_vec3_add((pl_vec3){(double)at[0], (double)at[1], (double)at[2]}, origin),
                        rock->center);
        assert_true(pl_vec3_norm(from) < 1.5 * d);
        assert_true(fabs(sqrt((double)(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])) - 1.0) < 1e-3);
      }
    }
  }
}

static void test_meshes(void **state) {
  (void)state;
  world world = make(20.0, 0.3, 50.0);
  size_t count = 0;
  for (uint8_t level = 14; level < 22; level++)
    for (uint32_t k = 0; k < 6; k++) {
      pl_vec3 origin;
      const pl_ground_tile_id id = {
          .i = (1u << level) / 3 + k, .j = (1u << level) / 5, .face = 2, .level = level};
      pl_ground_rocks *rocks = rocks_of(&world, id, &origin);
      if (rocks == NULL)
        continue;
      const double cell_m = pl_cube_cell_m(level + PL_GROUND_TILE_SHIFT, RADIUS_M);
      count += rocks->count;
      assert_int_equal(rocks->first[rocks->count], rocks->triangle_count);
      for (size_t n = 0; n < rocks->count; n++)
        assert_true(rocks->rocks[n].diameter_m >= 2.0 * cell_m * (1.0 - 1e-12));
      check_mesh(rocks, origin);
      pl_ground_rocks_destroy(rocks);
    }
  assert_true(count > 50);
  clear(&world);
}

/* What a coarse tile shows is in the finer tiles below it, the same but for its triangles. */
static size_t compare(const world *world, pl_ground_tile_id id) {
  pl_vec3 origin;
  pl_ground_rocks *coarse = rocks_of(world, id, &origin);
  size_t found = 0;
  if (coarse == NULL)
    return 0;
  for (uint32_t part = 0; part < 4; part++) {
    const pl_ground_tile_id inner = {.i = 2 * id.i + part % 2,
                                     .j = 2 * id.j + part / 2,
                                     .face = id.face,
                                     .level = (uint8_t)(id.level + 1)};
    pl_ground_rocks *fine = rocks_of(world, inner, &origin);
    for (size_t n = 0; fine != NULL && n < fine->count; n++)
      for (size_t k = 0; k < coarse->count; k++)
        if (coarse->rocks[k].id == fine->rocks[n].id) {
          found++;
          assert_memory_equal(&coarse->rocks[k].center, &fine->rocks[n].center, sizeof(pl_vec3));
          assert_true(fine->first[n + 1] - fine->first[n] ==
                      4 * (coarse->first[k + 1] - coarse->first[k]));
        }
    pl_ground_rocks_destroy(fine);
  }
  assert_int_equal(found, coarse->count);
  pl_ground_rocks_destroy(coarse);
  return found;
}

static void test_levels(void **state) {
  (void)state;
  world world = make(20.0, 0.3, 10.0);
  size_t count = 0;
  for (uint32_t k = 0; k < 10; k++) {
    const pl_ground_tile_id id = {.i = 20000 + k, .j = 12840, .face = 4, .level = 16};
    count += compare(&world, id);
  }
  assert_true(count > 20);
  clear(&world);
}

/* Few rocks: none below two cells, none where there are none. A rock of 50 m in cells of 1 cm has
 * the finest mesh, no more. */
static void test_hard(void **state) {
  (void)state;
  pl_vec3 origin;
  world none = make(0.0, 0.3, 50.0);
  const pl_ground_tile_id id = {.i = 3, .j = 5, .face = 1, .level = 18};
  assert_null(rocks_of(&none, id, &origin));
  clear(&none);
  world small = make(1.0, 0.05, 0.1);
  const pl_ground_tile_id coarse = {.i = 3, .j = 5, .face = 1, .level = 20}; /* cells of 8 cm */
  assert_null(rocks_of(&small, coarse, &origin));
  clear(&small);
  world large = make(2000.0, 40.0, 50.0);
  pl_rock *rocks;
  size_t count;
  assert_int_equal(pl_rock_list(large.rocks, large.terrain, (pl_vec3){1.0, 0.2, 0.1}, 1000.0, 40.0,
                                50.0, &rocks, &count),
                   PL_OK);
  assert_true(count > 0);
  int face;
  double s, t;
  pl_cube_locate(rocks[0].direction, &face, &s, &t);
  const uint8_t level = 23;
  const pl_ground_tile_id near = {.i = (uint32_t)ldexp(s + 1.0, level - 1),
                                  .j = (uint32_t)ldexp(t + 1.0, level - 1),
                                  .face = (uint8_t)face,
                                  .level = level};
  pl_ground_rocks *huge = rocks_of(&large, near, &origin);
  assert_non_null(huge);
  assert_int_equal(huge->triangle_count, 20480);
  assert_true(huge->rocks[0].id == rocks[0].id && huge->radius_m > 10.0);
  pl_ground_rocks_destroy(huge);
  pl_free(rocks);
  clear(&large);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_meshes), cmocka_unit_test(test_levels),
                                     cmocka_unit_test(test_hard)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
