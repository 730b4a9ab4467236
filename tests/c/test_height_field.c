/* The ground of a frame: no ray goes through it, hits mean what they say, and nothing depends on
 * what is kept or on the number of threads. */
#include "grounds.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "frame/height_fields.h"
#include "random.h"
#include "terrain/cube.h"
#include "trace/embree.h"
#include "trace/height_field.h"

static const double DEGREE = PL_PI / 180.0, MOON_M = 1737400.0, SMALL_M = 5000.0;
static const pl_vec3 SOMEWHERE = {0.9, 0.35, 0.2};

enum { PIXELS = PL_DRAWS(48, 12) };

typedef struct fixture {
  pl_terrain *terrain;
  pl_accelerators *kept;
  pl_arena arena;
  const pl_height_field *field;
} fixture;

static void open_fixture(fixture *f, pl_vec3 radii_m, double strength) {
  *f = (fixture){.terrain = ground_rough(radii_m, strength)};
  assert_int_equal(pl_accelerators_create(&f->kept), PL_OK);
  pl_arena_init(&f->arena);
}

static void close_fixture(fixture *f) {
  pl_accelerators_destroy(f->kept);
  pl_arena_clear(&f->arena);
  pl_terrain_destroy(f->terrain);
}

static void build(fixture *f, const pl_ground_tile_view *view, int threads) {
  assert_int_equal(
      pl_height_field_build(f->kept, f->terrain, view, threads, NULL, &f->arena, &f->field), PL_OK);
}

/* Casts one ray, given in body axes; returns the distance, or infinity, and the tile and u, v. */
typedef struct strike {
  double t;
  uint32_t tile;
  float u, v;
} strike;

static strike cast(const pl_height_field *field, pl_vec3 from, pl_vec3 to) {
  const pl_vec3f o = pl_vec3_to_float(pl_vec3_sub(from, field->origin));
  const pl_vec3f d = pl_vec3_to_float(pl_vec3_unit(pl_vec3_sub(to, from)));
  struct RTCRayHit ray = {.ray = {.org_x = o.x,
                                  .org_y = o.y,
                                  .org_z = o.z,
                                  .dir_x = d.x,
                                  .dir_y = d.y,
                                  .dir_z = d.z,
                                  .tfar = (float)pl_vec3_norm(pl_vec3_sub(to, from)),
                                  .mask = UINT32_MAX}};
  ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  pl_embree_intersect1(field->scene, NULL, &ray);
  const bool hit = ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  return (strike){hit ? (double)ray.ray.tfar : INFINITY, ray.hit.instID[0], ray.hit.u, ray.hit.v};
}

static pl_vec3 post_of(const pl_height_field *field, uint32_t tile, int i, int j) {
  const float *p = field->tiles[tile]->positions[(j + 1) * PL_GROUND_TILE_SIDE + i + 1];
  return pl_vec3_add(field->tiles[tile]->origin, (pl_vec3){p[0], p[1], p[2]});
}

/* A point of the ground that is hard to hit: on edges of tiles, beside their corners, or on edges
 * of cells. Exactly at posts, one ray in ten thousand passes between Embree's triangles
 * (test_ground_leak.c). */
static pl_vec3 hard_point(const pl_height_field *field, test_random *random, uint32_t *tile) {
  *tile = (uint32_t)random_below(random, (int)field->count);
  const int kind = random_below(random, 4);
  int i = random_below(random, PL_GROUND_TILE_CELLS),
      j = random_below(random, PL_GROUND_TILE_CELLS);
  i = kind == 0 ? 0 : i;
  j = kind <= 1 ? PL_GROUND_TILE_CELLS : j;
  const pl_vec3 p = post_of(field, *tile, i, j);
  const double along = random_unit(random) < 0.3 ? 1e-4 : random_unit(random);
  const pl_vec3 q = post_of(field, *tile, i + (kind != 0), j + (kind == 0));
  return pl_vec3_madd(p, along, pl_vec3_sub(q, p));
}

/* Mixed levels, beside an edge of the cube. */
static pl_ground_tile_view mixed_view(const fixture *f, pl_vec3 direction, double height_m) {
  pl_ground_tile_view view = ground_view(f->terrain, direction, height_m, 80.0 * DEGREE, PIXELS);
  view.half_angle_rad = PL_PI;
  view.side_count = 0;
  return view;
}

/* `slant`: greatest distance of rays from the vertical at some height, over this height: so small
 * that they start above the ground. */
static void check_closed(const fixture *f, pl_vec3 eye, double slant, uint64_t seed) {
  const pl_height_field *field = f->field;
  test_random random = {.seed = seed};
  int through = 0;
  for (int k = 0; k < PL_DRAWS(25000, 1000); k++) {
    uint32_t tile;
    const pl_vec3 p = hard_point(field, &random, &tile), up = pl_vec3_unit(p);
    const double height_m = fmin(30.0 * field->tiles[tile]->cell_m, 0.3 * field->radius_m);
    const pl_vec3 under = pl_vec3_madd(p, -height_m, up), over = pl_vec3_madd(p, height_m, up);
    const pl_vec3 aside =
        pl_vec3_madd(over, slant * height_m * random_unit(&random), random_direction(&random));
    /* Straight down, straight up from inside, at a slant through the point, grazing from the eye.
     */
    through += isinf(cast(field, over, under).t);
    through += isinf(cast(field, under, over).t);
    through += isinf(cast(field, aside, pl_vec3_sub(pl_vec3_scale(p, 2.0), aside)).t);
    through += isinf(cast(field, eye, under).t);
  }
  assert_int_equal(through, 0);
}

/* From the middle of the body outwards, and back: rounding is then that of its radius. */
static void check_closed_from_afar(const fixture *f, uint64_t seed) {
  test_random random = {.seed = seed};
  for (int k = 0; k < PL_DRAWS(20000, 1000); k++) {
    const pl_vec3 out = pl_vec3_scale(random_direction(&random), f->field->radius_m);
    const pl_vec3 middle = {0.0, 0.0, 0.0};
    const strike hit = cast(f->field, middle, out);
    assert_true(isfinite(hit.t) && hit.t > 0.5 * f->field->radius_m);
    assert_true(isfinite(cast(f->field, out, middle).t));
  }
}

static void no_ray_goes_through(void **state) {
  (void)state;
  const pl_vec3 spots[] = {{0.9, 0.35, 0.2}, {1.0, 1.0, 1.0}, {-1.0, 0.3, -0.9999}};
  for (int k = 0; k < PL_DRAWS(3, 2); k++) {
    const double radius_m = k == 1 ? SMALL_M : MOON_M;
    fixture f;
    open_fixture(&f, (pl_vec3){radius_m, radius_m, 0.9 * radius_m}, k == 2 ? 1.5 : 1.0);
    const pl_ground_tile_view view = mixed_view(&f, spots[k], k == 0 ? 2.0 : 300.0);
    build(&f, &view, 1);
    check_closed(&f, view.eye, 0.7, (uint64_t)k);
    check_closed_from_afar(&f, (uint64_t)k);
    close_fixture(&f);
  }
}

/* A board of steps of 100 m between posts 10 m apart, seen with cells much narrower than a step is
 * high. */
static void cliffs_are_closed(void **state) {
  (void)state;
  enum { SIDE = 64 };
  static float samples[SIDE * SIDE];
  for (int k = 0; k < SIDE * SIDE; k++)
    samples[k] = (k % SIDE / 4 + k / SIDE / 4) % 2 == 1 ? 100.0f : 0.0f;
  const double lon = 0.3, lat = 0.2;
  const pl_raster_frame frame = {.samples = samples,
                                 .type = PL_RASTER_FLOAT32,
                                 .width = SIDE,
                                 .height = SIDE,
                                 .scale = 1.0,
                                 .projection = {.kind = PL_PROJECTION_ORTHOGRAPHIC,
                                                .lon0_rad = lon,
                                                .lat0_rad = lat,
                                                .radius_m = MOON_M},
                                 .x0 = -315.0,
                                 .y0 = 315.0,
                                 .dx = 10.0,
                                 .dy = -10.0};
  pl_raster *raster;
  assert_int_equal(pl_raster_create(&frame, &raster), PL_OK);
  const pl_terrain_layer layer = {.raster = raster, .border_posts = 4.0};
  const pl_terrain_frame ground = {.radii_m = {MOON_M, MOON_M, MOON_M},
                                   .layers = &layer,
                                   .layer_count = 1,
                                   .detail = {.on = false}};
  fixture f = {0};
  assert_int_equal(pl_terrain_create(&ground, &f.terrain), PL_OK);
  assert_int_equal(pl_accelerators_create(&f.kept), PL_OK);
  pl_arena_init(&f.arena);
  const pl_vec3 up = {cos(lon) * cos(lat), sin(lon) * cos(lat), sin(lat)};
  const pl_ground_tile_view view = mixed_view(&f, up, 150.0);
  build(&f, &view, 1);
  check_closed(&f, view.eye, 0.01, 11);
  close_fixture(&f);
  pl_raster_destroy(raster);
}

/* Above inner posts, rays straight down meet the height function of the tile's level. */
static void depths_are_the_height_function(void **state) {
  (void)state;
  fixture f;
  test_random random = {.seed = 8};
  open_fixture(&f, (pl_vec3){MOON_M, MOON_M, MOON_M}, 1.0);
  const pl_ground_tile_view view = mixed_view(&f, SOMEWHERE, 20.0);
  build(&f, &view, 1);
  for (int k = 0; k < PL_DRAWS(5000, 500); k++) {
    const uint32_t index = (uint32_t)random_below(&random, (int)f.field->count);
    const pl_ground_tile *tile = f.field->tiles[index];
    const int level = pl_ground_tile_lattice(tile->id);
    const int i = 1 + random_below(&random, PL_GROUND_TILE_CELLS - 1);
    const int j = 1 + random_below(&random, PL_GROUND_TILE_CELLS - 1);
    const pl_vec3 d = pl_cube_direction(
        tile->id.face, pl_cube_node(level, (int64_t)tile->id.i * PL_GROUND_TILE_CELLS + i),
        pl_cube_node(level, (int64_t)tile->id.j * PL_GROUND_TILE_CELLS + j));
    const double radius_m =
        pl_terrain_datum_m(f.terrain, d) + pl_terrain_height(f.terrain, d, level);
    const strike hit = cast(f.field, pl_vec3_scale(d, radius_m + 10.0 * tile->cell_m),
                            pl_vec3_scale(d, radius_m - 10.0 * tile->cell_m));
    assert_int_equal(hit.tile, index);
    assert_true(fabs(hit.t - 10.0 * tile->cell_m) < 2e-3 * tile->cell_m);
  }
  close_fixture(&f);
}

/* The point that u, v stand for lies on the ray, in the triangle whose corners are returned, and
 * the triangle's normal faces the ray. */
static void hits_are_decoded(void **state) {
  (void)state;
  fixture f;
  test_random random = {.seed = 9};
  open_fixture(&f, (pl_vec3){SMALL_M, SMALL_M, SMALL_M}, 1.0);
  const pl_ground_tile_view view = mixed_view(&f, SOMEWHERE, 20.0);
  build(&f, &view, 1);
  size_t hits = 0;
  for (int k = 0; k < PL_DRAWS(20000, 1000); k++) {
    const pl_vec3 to = pl_vec3_madd(view.eye, 4000.0, random_direction(&random));
    const strike hit = cast(f.field, view.eye, to);
    if (isinf(hit.t))
      continue;
    hits++;
    const pl_vec3 d = pl_vec3_unit(pl_vec3_sub(to, view.eye));
    const pl_vec3 p = pl_height_field_point(f.field, hit.tile, hit.u, hit.v);
    const double cell_m = f.field->tiles[hit.tile]->cell_m;
    const double off = pl_vec3_norm(pl_vec3_sub(pl_vec3_madd(view.eye, hit.t, d), p));
    assert_true(off < 1e-3 * cell_m + 1e-6 * hit.t);
    pl_vec3 corners[3];
    double weights[3];
    pl_height_field_corners(f.field, hit.tile, hit.u, hit.v, corners, weights);
    for (int n = 0; n < 3; n++)
      assert_true(weights[n] > -1e-4 && weights[n] < 1.0001);
    const pl_vec3 facet = ground_facet_normal(f.field, hit.tile, hit.u, hit.v);
    assert_true(pl_vec3_dot(facet, d) < 1e-3);
    assert_true(pl_vec3_dot(facet, pl_vec3_unit(p)) > 0.0);
    const pl_vec3 smooth = pl_height_field_normal(f.field, hit.tile, hit.u, hit.v);
    assert_true(fabs(pl_vec3_norm(smooth) - 1.0) < 1e-12);
    assert_true(pl_vec3_norm(pl_vec3_sub(smooth, facet)) < 0.8);
    const pl_height_field_cell cell = pl_height_field_locate(hit.u, hit.v);
    assert_in_range(cell.column + 1, 0, PL_GROUND_TILE_CELLS + 1);
    assert_in_range(cell.row + 1, 0, PL_GROUND_TILE_CELLS + 1);
  }
  assert_true(hits > PL_DRAWS(8000, 400));
  close_fixture(&f);
}

/* --- what is kept ----------------------------------------------------------------------------- */

/* Hash of tiles and of hits on them. */
static uint64_t print_of(const fixture *f, pl_vec3 eye) {
  uint64_t sum = 1469598103934665603u;
  test_random random = {.seed = 5};
  for (size_t k = 0; k < f->field->count; k++) {
    const unsigned char *bytes = (const unsigned char *)f->field->tiles[k]->positions;
    for (size_t n = 0; n < sizeof f->field->tiles[k]->positions; n += 7)
      sum = (sum ^ bytes[n]) * 1099511628211u;
  }
  for (int k = 0; k < 2000; k++) {
    const pl_vec3 to = pl_vec3_madd(eye, 4000.0, random_direction(&random));
    const strike hit = cast(f->field, eye, to);
    uint32_t words[3];
    memcpy(words, &hit.u, 4);
    memcpy(words + 1, &hit.v, 4);
    words[2] = isinf(hit.t) ? 7 : hit.tile;
    for (int n = 0; n < 3; n++)
      sum = (sum ^ words[n]) * 1099511628211u;
  }
  return sum;
}

static void bits_do_not_depend_on_threads_or_what_is_kept(void **state) {
  (void)state;
  fixture fresh, used;
  open_fixture(&fresh, (pl_vec3){SMALL_M, SMALL_M, SMALL_M}, 1.0);
  open_fixture(&used, (pl_vec3){SMALL_M, SMALL_M, SMALL_M}, 1.0);
  pl_ground_tile_view view = ground_view(fresh.terrain, SOMEWHERE, 20.0, 70.0 * DEGREE, PIXELS);
  const pl_ground_tile_view other =
      ground_view(fresh.terrain, SOMEWHERE, 80.0, 70.0 * DEGREE, PIXELS);
  build(&fresh, &view, 1);
  const uint64_t wanted = print_of(&fresh, view.eye);
  build(&used, &other, 3);
  const uint64_t made = pl_ground_tiles_used(used.kept).made;
  build(&used, &view, 2);
  assert_true(print_of(&used, view.eye) == wanted);
  /* Some were kept, and all are. */
  const uint64_t more = pl_ground_tiles_used(used.kept).made - made;
  assert_true(more > 0 && more < used.field->count);
  pl_ground_tiles_trim(used.kept);
  build(&used, &view, 2);
  assert_int_equal(pl_ground_tiles_used(used.kept).made, made + more);
  assert_true(print_of(&used, view.eye) == wanted);
  close_fixture(&fresh);
  close_fixture(&used);
}

static void tiles_above_the_limit_are_evicted(void **state) {
  (void)state;
  fixture f;
  open_fixture(&f, (pl_vec3){SMALL_M, SMALL_M, SMALL_M}, 1.0);
  const pl_ground_tile_view near = ground_view(f.terrain, SOMEWHERE, 20.0, 70.0 * DEGREE, PIXELS);
  const pl_ground_tile_view other =
      ground_view(f.terrain, (pl_vec3){-1.0, 0.2, 0.5}, 20.0, 1.0, PIXELS);
  build(&f, &near, 2);
  const uint64_t wanted = print_of(&f, near.eye);
  pl_ground_tiles_use use = pl_ground_tiles_used(f.kept);
  const size_t near_count = f.field->count;
  print_message("[          ] %zu tiles of %zu bytes\n", use.tiles, use.bytes / use.tiles);
  assert_int_equal(use.tiles, near_count);
  assert_in_range(use.bytes / use.tiles, sizeof(pl_ground_tile), 36000);
  pl_ground_tiles_trim(f.kept);
  assert_int_equal(pl_ground_tiles_used(f.kept).tiles, near_count); /* within the limit */
  build(&f, &other, 2);
  const size_t other_count = f.field->count, both = pl_ground_tiles_used(f.kept).tiles;
  assert_true(both > near_count);
  /* Room for the tiles of the last frame and a few more: the others go first. */
  f.kept->ground->limit = (other_count + 5) * 34000;
  assert_int_equal(pl_ground_tiles_used(f.kept).tiles, both); /* never within a frame */
  pl_ground_tiles_trim(f.kept);
  use = pl_ground_tiles_used(f.kept);
  assert_true(use.tiles < both && use.bytes <= (other_count + 5) * 34000);
  const uint64_t made = use.made;
  build(&f, &other, 1);
  assert_in_range(pl_ground_tiles_used(f.kept).made - made, 0, other_count / 4);
  build(&f, &near, 1);
  assert_true(print_of(&f, near.eye) == wanted);
  ground_tiles_evict(f.kept);
  assert_int_equal(pl_ground_tiles_used(f.kept).tiles, 0);
  assert_int_equal(pl_ground_tiles_used(f.kept).bytes, 0);
  build(&f, &near, 2);
  assert_true(print_of(&f, near.eye) == wanted);
  close_fixture(&f);
}

/* Two bodies in one frame, of which one is then destroyed. */
static void terrains_are_kept_apart(void **state) {
  (void)state;
  fixture f;
  open_fixture(&f, (pl_vec3){SMALL_M, SMALL_M, SMALL_M}, 1.0);
  pl_terrain *second = ground_rough((pl_vec3){SMALL_M, SMALL_M, SMALL_M}, 2.0);
  assert_true(pl_terrain_number(second) != pl_terrain_number(f.terrain));
  const pl_ground_tile_view view = ground_view(f.terrain, SOMEWHERE, 200.0, 0.0, PIXELS);
  const pl_height_field *rough;
  build(&f, &view, 1);
  const uint64_t wanted = print_of(&f, view.eye);
  assert_int_equal(pl_height_field_build(f.kept, second, &view, 1, NULL, &f.arena, &rough), PL_OK);
  assert_true(print_of(&f, view.eye) == wanted); /* both are in use */
  const pl_vec3 away = {0.0, 0.0, 0.0};
  assert_true(cast(rough, view.eye, away).t != cast(f.field, view.eye, away).t);
  pl_terrain_destroy(second);
  const uint64_t made = pl_ground_tiles_used(f.kept).made;
  build(&f, &view, 1);
  assert_int_equal(pl_ground_tiles_used(f.kept).made, made);
  assert_true(print_of(&f, view.eye) == wanted);
  close_fixture(&f);
}

static bool stop(void *context) {
  int *left = context;
  return (*left)-- <= 0;
}

/* A build that is cancelled leaves nothing half made. */
static void builds_can_be_cancelled(void **state) {
  (void)state;
  fixture f;
  open_fixture(&f, (pl_vec3){SMALL_M, SMALL_M, SMALL_M}, 1.0);
  const pl_ground_tile_view view = ground_view(f.terrain, SOMEWHERE, 200.0, 0.0, PIXELS);
  int left = 10;
  pl_cancel cancel = {.poll = stop, .context = &left};
  assert_int_equal(pl_height_field_build(f.kept, f.terrain, &view, 2, &cancel, &f.arena, &f.field),
                   PL_E_CANCELLED);
  assert_int_equal(pl_ground_tiles_used(f.kept).tiles, 0);
  build(&f, &view, 2);
  assert_true(print_of(&f, view.eye) != 0);
  close_fixture(&f);
}

static void *fail_after(void *context, size_t size) {
  int *left = context;
  return (*left)-- > 0 ? malloc(size) : NULL;
}

static void every_failed_allocation_is_an_error(void **state) {
  (void)state;
  fixture f;
  open_fixture(&f, (pl_vec3){SMALL_M, SMALL_M, SMALL_M}, 1.0);
  pl_ground_tile_view view = ground_view(f.terrain, SOMEWHERE, 20000.0, 0.0, 8);
  pl_status status = PL_E_MEMORY;
  int most = 0;
  for (; status != PL_OK; most++) {
    int left = most;
    pl_memory_hook(fail_after, &left);
    status = pl_height_field_build(f.kept, f.terrain, &view, 1, NULL, &f.arena, &f.field);
    pl_memory_hook(NULL, NULL);
    assert_true(status == PL_OK || status == PL_E_MEMORY);
    pl_arena_clear(&f.arena);
    pl_arena_init(&f.arena);
    most += most > 12 ? 20 : 0;
    ground_tiles_evict(f.kept);
  }
  assert_true(most > 5);
  close_fixture(&f);
}

static void reports_name_the_body_of_the_widest_cells(void **state) {
  (void)state;
  char names[3][8] = {"moon", "mars", "phobos"};
  pl_body bodies[3] = {{.name = names[0]}, {.name = names[1]}, {.name = names[2]}};
  pl_height_field fields[2] = {{.count = 5, .widened = 1.0},
                               {.count = 7, .widened = 1.5, .patch_missed = true}};
  pl_shot_body shot_bodies[3] = {{.body = &bodies[0], .field = &fields[0]},
                                 {.body = &bodies[1], .field = &fields[1]},
                                 {.body = &bodies[2]}};
  const pl_snapshot shot = {.bodies = shot_bodies, .body_count = 3};
  pl_accelerators *kept;
  pl_frame_result result;
  assert_int_equal(pl_accelerators_create(&kept), PL_OK);
  pl_height_fields_report(kept, &shot, &result);
  assert_int_equal(result.ground_tiles, 12);
  assert_true(result.ground_widened == 1.5);
  assert_string_equal(result.ground_widened_body, "mars");
  assert_string_equal(result.ground_missed_body, "mars");
  fields[1].widened = 1.0;
  fields[1].patch_missed = false;
  pl_height_fields_report(kept, &shot, &result);
  assert_true(result.ground_widened == 1.0 && result.ground_widened_body == NULL);
  assert_null(result.ground_missed_body);
  pl_accelerators_destroy(kept);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      serial_unit_test(reports_name_the_body_of_the_widest_cells),
      serial_unit_test(no_ray_goes_through),
      serial_unit_test(cliffs_are_closed),
      serial_unit_test(depths_are_the_height_function),
      serial_unit_test(hits_are_decoded),
      cmocka_unit_test(bits_do_not_depend_on_threads_or_what_is_kept),
      cmocka_unit_test(tiles_above_the_limit_are_evicted),
      serial_unit_test(terrains_are_kept_apart),
      cmocka_unit_test(builds_can_be_cancelled),
      serial_unit_test(every_failed_allocation_is_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
