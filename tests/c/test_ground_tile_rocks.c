/* Rocks of tiles: closed meshes of the right size, the same rocks at any level of detail. */
#include "harness.h"

#include <math.h>

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

/* Gives rocks their meshes, and those that are new their vertices. */
static void link_all(pl_ground_rocks *rocks, pl_rock_meshes *meshes, const world *world) {
  const size_t before = meshes->count;
  assert_int_equal(pl_ground_rocks_link(rocks, meshes), PL_OK);
  for (size_t k = before; k < meshes->count; k++)
    assert_int_equal(
        pl_rock_mesh_fill(meshes->list[k], meshes,
                          &pl_rock_field_variants(world->rocks)[meshes->list[k]->variant]),
        PL_OK);
}

/* Corner of a triangle of a rock, about the rock's centre. */
static pl_vec3 corner_of(const pl_ground_rock *rock, int triangle, int c) {
  const uint32_t v = rock->mesh->triangles[triangle][c];
  assert_true(v < (uint32_t)rock->mesh->vertex_count);
  const float *at = rock->mesh->positions[v];
  return pl_ground_rock_out(rock, (pl_vec3){(double)at[0], (double)at[1], (double)at[2]});
}

/* Volume and the sum of the normals' areas of a rock's triangles, which vanishes for a closed mesh.
 */
static double volume_of(const pl_ground_rock *rock, pl_vec3 *open) {
  double volume = 0.0;
  *open = (pl_vec3){0.0, 0.0, 0.0};
  for (int t = 0; t < rock->mesh->triangle_count; t++) {
    pl_vec3 p[3];
    for (int c = 0; c < 3; c++)
      p[c] = corner_of(rock, t, c);
    const pl_vec3 n = pl_vec3_cross(pl_vec3_sub(p[1], p[0]), pl_vec3_sub(p[2], p[0]));
    *open = pl_vec3_add(*open, n);
    volume += pl_vec3_dot(p[0], n) / 6.0;
  }
  return volume;
}

/* Smooth normals of a rock against those of its triangles about each vertex. */
static void check_normals(const pl_ground_rock *rock) {
  enum { MOST = 10242 };
  static pl_vec3 sums[MOST];
  const pl_rock_mesh *mesh = rock->mesh;
  for (int v = 0; v < mesh->vertex_count; v++)
    sums[v] = (pl_vec3){0.0, 0.0, 0.0};
  for (int t = 0; t < mesh->triangle_count; t++) {
    const pl_vec3 p = corner_of(rock, t, 0);
    const pl_vec3 n =
        pl_vec3_cross(pl_vec3_sub(corner_of(rock, t, 1), p), pl_vec3_sub(corner_of(rock, t, 2), p));
    for (int c = 0; c < 3; c++)
      sums[mesh->triangles[t][c]] = pl_vec3_add(sums[mesh->triangles[t][c]], n);
  }
  for (int v = 0; v < mesh->vertex_count; v++) {
    const float *n = mesh->normals[v];
    const pl_vec3 own =
        pl_ground_rock_normal(rock, (pl_vec3){(double)n[0], (double)n[1], (double)n[2]});
    assert_true(pl_vec3_dot(pl_vec3_unit(own), pl_vec3_unit(sums[v])) > 1.0 - 1e-6);
  }
}

static void check_rocks(const pl_ground_rocks *rocks) {
  for (size_t k = 0; k < rocks->count; k++) {
    const pl_ground_rock *rock = &rocks->rocks[k];
    const double d = rock->rock.diameter_m;
    pl_vec3 open;
    const double volume = volume_of(rock, &open);
    /* An ellipsoid of axes 1, 1 and 0.6 has 0.31. */
    if (!(volume > 0.05 * d * d * d && volume < 0.8 * d * d * d))
      fail_msg("rock of %g m, family %d: volume %g", d, (int)rock->rock.family, volume);
    assert_true(pl_vec3_norm(open) < 1e-3 * d * d);
    check_normals(rock);
    const uint32_t count = rocks->first[k + 1] - rocks->first[k];
    assert_int_equal(count, rock->mesh->triangle_count);
    assert_int_equal(pl_ground_rocks_of(rocks, rocks->first[k]), k);
    assert_int_equal(pl_ground_rocks_of(rocks, rocks->first[k] + count - 1), k);
    const pl_vec3 center = pl_vec3_sub(rock->rock.center, rocks->origin);
    for (int t = 0; t < rock->mesh->triangle_count; t++)
      for (int c = 0; c < 3; c++) {
        const pl_vec3 p = corner_of(rock, t, c);
        const pl_vec3 back = pl_ground_rock_out(rock, pl_ground_rock_in(rock, p));
        assert_true(pl_vec3_norm(pl_vec3_sub(back, p)) < 1e-9 * d);
        assert_true(pl_vec3_norm(pl_vec3_add(center, p)) <= rocks->radius_m);
      }
  }
}

static void test_meshes(void **state) {
  (void)state;
  world world = make(20.0, 0.3, 50.0);
  pl_rock_meshes meshes = {0};
  size_t count = 0;
  for (uint8_t level = 14; level < 22; level++)
    for (uint32_t k = 0; k < 6; k++) {
      pl_vec3 origin;
      const pl_ground_tile_id id = {
          .i = (1u << level) / 3 + k, .j = (1u << level) / 5, .face = 2, .level = level};
      pl_ground_rocks *rocks = rocks_of(&world, id, &origin);
      if (rocks == NULL)
        continue;
      link_all(rocks, &meshes, &world);
      const double cell_m = pl_cube_cell_m(level + PL_GROUND_TILE_SHIFT, RADIUS_M);
      count += rocks->count;
      assert_int_equal(rocks->first[rocks->count], rocks->triangle_count);
      for (size_t n = 0; n < rocks->count; n++)
        assert_true(rocks->rocks[n].rock.diameter_m >= 2.0 * cell_m * (1.0 - 1e-12));
      check_rocks(rocks);
      pl_ground_rocks_destroy(rocks);
    }
  assert_true(count > 50);
  /* Rocks share meshes. */
  assert_true(meshes.count < count);
  pl_rock_meshes_clear(&meshes);
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
        if (coarse->rocks[k].rock.id == fine->rocks[n].rock.id) {
          found++;
          assert_memory_equal(&coarse->rocks[k].rock.center, &fine->rocks[n].rock.center,
                              sizeof(pl_vec3));
          assert_ptr_equal(coarse->rocks[k].variant, fine->rocks[n].variant);
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
  assert_true(huge->rocks[0].rock.id == rocks[0].id && huge->radius_m > 10.0);
  pl_ground_rocks_destroy(huge);
  pl_free(rocks);
  clear(&large);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_meshes), cmocka_unit_test(test_levels),
                                     cmocka_unit_test(test_hard)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
