/* Rocks in the scene of a height field: rays hit those that the field lists, and hits are decoded.
 */
#include "grounds.h"

#include <string.h>

#include "base/memory.h"
#include "terrain/rock_field.h"
#include "trace/embree.h"
#include "trace/height_field.h"
#include "trace/instance.h"

static const double MOON_M = 1737400.0;
static const pl_vec3 SOMEWHERE = {0.9, 0.35, 0.2};

typedef struct fixture {
  pl_rock_field *rocks;
  pl_terrain *terrain;
  pl_accelerators *kept;
  pl_arena arena;
  const pl_height_field *field;
} fixture;

static pl_terrain *terrain_with(const pl_rock_field *rocks) {
  const pl_terrain_frame frame = {.radii_m = {MOON_M, MOON_M, MOON_M},
                                  .detail = pl_terrain_detail_default(MOON_M),
                                  .rocks = rocks};
  pl_terrain *terrain;
  assert_int_equal(pl_terrain_create(&frame, &terrain), PL_OK);
  return terrain;
}

static void open_world(fixture *f, const pl_rock_frame *frame, bool with_rocks) {
  *f = (fixture){0};
  assert_int_equal(pl_rock_field_create(frame, &f->rocks), PL_OK);
  f->terrain = terrain_with(with_rocks ? f->rocks : NULL);
  assert_int_equal(pl_accelerators_create(&f->kept), PL_OK);
  pl_arena_init(&f->arena);
}

static void build_at(fixture *f, pl_vec3 place) {
  const pl_ground_tile_view view = ground_view(f->terrain, place, 12.0, 0.0, 48);
  assert_int_equal(pl_height_field_build(f->kept, f->terrain, &view, 2, NULL, &f->arena, &f->field),
                   PL_OK);
}

static void open_fixture(fixture *f, bool with_rocks) {
  pl_rock_frame frame = pl_rock_frame_default(MOON_M);
  frame.law = (pl_rock_law){.kind = PL_ROCKS_HAWORTH, .factor = 4.0};
  frame.min_m = 0.3;
  open_world(f, &frame, with_rocks);
  build_at(f, SOMEWHERE);
}

static void close_fixture(fixture *f) {
  pl_accelerators_destroy(f->kept);
  pl_arena_clear(&f->arena);
  pl_terrain_destroy(f->terrain);
  pl_rock_field_destroy(f->rocks);
}

/* Casts a ray from above a rock to its centre, in mesh units of the field. */
static struct RTCRayHit cast(const pl_height_field *field, const pl_rock *rock) {
  const pl_vec3 from = pl_vec3_madd(rock->center, 3.0 * rock->diameter_m, rock->up);
  const pl_vec3f o = pl_vec3_to_float(pl_vec3_sub(from, field->origin));
  const pl_vec3f d = pl_vec3_to_float(pl_vec3_scale(rock->up, -1.0));
  struct RTCRayHit ray = {.ray = {.org_x = o.x,
                                  .org_y = o.y,
                                  .org_z = o.z,
                                  .dir_x = d.x,
                                  .dir_y = d.y,
                                  .dir_z = d.z,
                                  .tfar = INFINITY,
                                  .mask = UINT32_MAX}};
  ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  pl_embree_intersect1(field->scene, NULL, &ray);
  return ray;
}

static void check_hit(const pl_height_field *field, const struct RTCRayHit *ray,
                      const pl_rock *rock) {
  const uint32_t triangle = field->first_rocks[ray->hit.instID[0]] + ray->hit.primID;
  const pl_rock_hit hit = pl_height_field_rock(field, triangle);
  assert_true(hit.rock->rock.id == rock->id);
  pl_vec3 corners[3];
  pl_rock_hit_corners(field, &hit, corners);
  const float w[3] = {1.0f - ray->hit.u - ray->hit.v, ray->hit.u, ray->hit.v};
  pl_vec3 point = {0.0, 0.0, 0.0};
  for (int c = 0; c < 3; c++)
    point = pl_vec3_madd(point, (double)w[c], corners[c]);
  const pl_vec3 from =
      pl_vec3_sub(pl_vec3_madd(rock->center, 3.0 * rock->diameter_m, rock->up), field->origin);
  const pl_vec3 there = pl_vec3_madd(from, -(double)ray->ray.tfar, rock->up);
  assert_true(pl_vec3_norm(pl_vec3_sub(point, there)) < 1e-4 * rock->diameter_m);
  assert_true(pl_vec3_dot(pl_rock_hit_normal(&hit, w), rock->up) > 0.0);
}

static void rocks_of_the_list_are_hit(void **state) {
  (void)state;
  fixture f;
  open_fixture(&f, true);
  pl_rock *rocks;
  size_t count;
  int hits = 0;
  assert_non_null(f.field->first_rocks);
  /* The frame is 13 m wide: cells are 0.3 m at most, and show rocks of 0.6 m. */
  assert_int_equal(pl_rock_list(f.rocks, f.terrain, SOMEWHERE, 6.0, 0.7, 50.0, &rocks, &count),
                   PL_OK);
  assert_true(count > 0);
  for (size_t k = 0; k < count; k++) {
    const struct RTCRayHit ray = cast(f.field, &rocks[k]);
    assert_true(ray.hit.geomID != RTC_INVALID_GEOMETRY_ID);
    if (ray.hit.geomID != PL_TILE_ROCKS)
      continue; /* the ground of a coarse cell may lie over a deeply buried rock */
    const uint32_t triangle = f.field->first_rocks[ray.hit.instID[0]] + ray.hit.primID;
    if (pl_height_field_rock(f.field, triangle).rock->rock.id != rocks[k].id)
      continue; /* a larger rock over it */
    check_hit(f.field, &ray, &rocks[k]);
    hits++;
  }
  if (!(hits > 0.8 * (double)count))
    fail_msg("%d of %zu rocks hit", hits, count);
  pl_free(rocks);
  close_fixture(&f);
}

/* The law says how many rocks tiles will have; as many as made, over all tiles of a frame, within
 * what chance and slopes leave. */
static void rocks_are_expected(void **state) {
  (void)state;
  fixture f;
  open_fixture(&f, true);
  double expected = 0.0, made = 0.0;
  for (size_t k = 0; k < f.field->count; k++) {
    const pl_ground_tile *tile = f.field->tiles[k];
    expected += pl_ground_rocks_expected(f.rocks, MOON_M, tile->id);
    made += tile->rocks != NULL ? (double)tile->rocks->count : 0.0;
  }
  assert_true(expected > 100.0);
  if (!(fabs(made - expected) < 4.0 * sqrt(expected) + 0.1 * expected))
    fail_msg("%g rocks, %g expected", made, expected);
  close_fixture(&f);
}

/* More than a frame may have are an error, before any is made. */
static void too_many_rocks_are_refused(void **state) {
  (void)state;
  fixture f;
  pl_rock_frame frame = pl_rock_frame_default(MOON_M);
  frame.law =
      (pl_rock_law){.kind = PL_ROCKS_POWER, .factor = 1.0, .coefficient = 0.55, .exponent = -2.0};
  frame.min_m = 0.02;
  frame.max_m = 0.035;
  open_world(&f, &frame, true);
  pl_ground_tile_view view = ground_view(f.terrain, SOMEWHERE, 40.0, 0.0, 5000);
  view.limit = 1u << 20;
  assert_int_equal(pl_height_field_build(f.kept, f.terrain, &view, 1, NULL, &f.arena, &f.field),
                   PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "at most 2e+06: raise min_diameter_m or lower"));
  assert_int_equal(pl_ground_tiles_used(f.kept).tiles, 0);
  close_fixture(&f);
}

/* Without rocks there is none, nor memory for them. */
static void rocks_are_counted(void **state) {
  (void)state;
  fixture with, without;
  open_fixture(&with, true);
  open_fixture(&without, false);
  assert_null(without.field->first_rocks);
  for (size_t k = 0; k < without.field->count; k++)
    assert_null(without.field->tiles[k]->rocks);
  size_t bytes = 0;
  for (size_t k = 0; k < with.field->count; k++)
    bytes += with.field->tiles[k]->rocks != NULL ? with.field->tiles[k]->rocks->bytes : 0;
  assert_true(bytes > 0);
  const pl_ground_tiles_use more = pl_ground_tiles_used(with.kept);
  const pl_ground_tiles_use less = pl_ground_tiles_used(without.kept);
  assert_true(more.bytes >= less.bytes + bytes);
  close_fixture(&with);
  close_fixture(&without);
}

static void rocks_of_another_body_are_refused(void **state) {
  (void)state;
  const pl_rock_frame frame = pl_rock_frame_default(3389500.0);
  pl_rock_field *rocks;
  assert_int_equal(pl_rock_field_create(&frame, &rocks), PL_OK);
  const pl_terrain_frame ground = {.radii_m = {MOON_M, MOON_M, MOON_M}, .rocks = rocks};
  pl_terrain *terrain;
  assert_int_equal(pl_terrain_create(&ground, &terrain), PL_E_RANGE);
  pl_rock_field_destroy(rocks);
}

/* Meshes of rocks leave with the last tile that shows them; those of other tiles stay. */
static void meshes_leave_with_their_tiles(void **state) {
  (void)state;
  fixture f;
  open_fixture(&f, true);
  const pl_ground_tiles_use first = pl_ground_tiles_used(f.kept);
  assert_true(first.rock_meshes > 0);
  pl_ground_tiles_trim(f.kept);
  assert_int_equal(pl_ground_tiles_used(f.kept).rock_meshes, first.rock_meshes);
  build_at(&f, (pl_vec3){-0.5, 0.1, 0.8});
  assert_true(pl_ground_tiles_used(f.kept).rock_meshes >= first.rock_meshes);
  f.kept->ground->limit = first.bytes;
  pl_ground_tiles_trim(f.kept); /* the tiles of the first place leave */
  for (int turn = 0; turn < PL_DRAWS(3, 2); turn++) {
    build_at(&f, SOMEWHERE);
    pl_ground_tiles_trim(f.kept);
    assert_true(pl_ground_tiles_used(f.kept).bytes <= first.bytes);
    assert_in_range(pl_ground_tiles_used(f.kept).rock_meshes, 1, first.rock_meshes);
  }
  ground_tiles_evict(f.kept);
  assert_int_equal(pl_ground_tiles_used(f.kept).rock_meshes, 0);
  build_at(&f, SOMEWHERE);
  assert_int_equal(pl_ground_tiles_used(f.kept).rock_meshes, first.rock_meshes);
  close_fixture(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rocks_of_the_list_are_hit),
      cmocka_unit_test(rocks_are_expected),
      cmocka_unit_test(too_many_rocks_are_refused),
      cmocka_unit_test(rocks_are_counted),
      cmocka_unit_test(rocks_of_another_body_are_refused),
      cmocka_unit_test(meshes_leave_with_their_tiles),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
