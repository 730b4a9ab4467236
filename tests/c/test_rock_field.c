/* Rocks of a body: counts, sizes, places, seats on the ground, ids, hard cases. */
#include "harness.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "random.h"
#include "terrain/rock_field.h"
#include "terrain/rock_surface.h"

static const double RADIUS_M = 1737400.0;

static pl_terrain *rough_moon(double strength) {
  pl_terrain_frame frame = {.radii_m = {RADIUS_M, RADIUS_M, RADIUS_M},
                            .detail = pl_terrain_detail_default(RADIUS_M)};
  frame.detail.strength = strength;
  frame.detail.on = strength > 0.0;
  pl_terrain *terrain;
  assert_int_equal(pl_terrain_create(&frame, &terrain), PL_OK);
  return terrain;
}

static pl_rock_field *field_of(const pl_rock_frame *frame) {
  pl_rock_field *field;
  if (pl_rock_field_create(frame, &field) != PL_OK)
    fail_msg("%s", pl_error_text());
  return field;
}

static pl_rock_frame frame_of(pl_rock_law_kind kind, double min_m, double max_m) {
  pl_rock_frame frame = pl_rock_frame_default(RADIUS_M);
  frame.law = (pl_rock_law){.kind = kind, .factor = 1.0};
  frame.min_m = min_m;
  frame.max_m = max_m;
  frame.seed = 19;
  return frame;
}

typedef struct tally {
  int count;
  int bins[16];
  const pl_rock_law *law;
  double most, least;
} tally;

static pl_status add(void *context, const pl_scatter_site *site) {
  tally *tally = context;
  const double n = pl_rock_density(tally->law, site->diameter_m);
  const int bin = (int)(16.0 * (tally->most - n) / (tally->most - tally->least));
  tally->bins[bin < 0 ? 0 : bin > 15 ? 15 : bin]++;
  tally->count++;
  return PL_OK;
}

/* Solid angle of a small square of the lattice times R^2. */
static double area_of(const pl_rock_square *square) {
  const double s = ldexp((double)square->i + 0.5, 1 - square->level) - 1.0;
  const double t = ldexp((double)square->j + 0.5, 1 - square->level) - 1.0;
  const double a = pl_cube_tangent(s), b = pl_cube_tangent(t), q = 1.0 + a * a + b * b;
  const double cell = pl_cube_cell_m(square->level, RADIUS_M);
  return cell * cell * (1.0 + a * a) * (1.0 + b * b) / (q * sqrt(q));
}

/* Counts of squares all over the body are Poisson with the law's mean, and the diameters are those
 * of the law: chi-square with 600 degrees of freedom is above 780 in 1e-6 of all seeds, with 15
 * above 55 in 2e-6. */
static void test_counts(void **state) {
  (void)state;
  enum { SQUARES = 600 };
  test_random random = {.seed = 3};
  const pl_rock_frame frame = frame_of(PL_ROCKS_HAWORTH, 0.05, 5.0);
  pl_rock_field *field = field_of(&frame);
  double square_sum = 0.0;
  const int level = 15; /* 83 m */
  const double width_m = pl_cube_cell_m(level, RADIUS_M);
  tally all = {.law = &frame.law,
               .most = pl_rock_density(&frame.law, width_m / 16.0),
               .least = pl_rock_density(&frame.law, 5.0)};
  const int finer = 5;
  const double least_m = width_m / 16.0 / (1 << finer);
  assert_true(least_m > 0.05);
  all.most = pl_rock_density(&frame.law, least_m);
  for (int k = 0; k < SQUARES; k++) {
    const int cells = 1 << (level + finer);
    const pl_rock_square square = {random_below(&random, 6), level + finer,
                                   (uint64_t)random_below(&random, cells),
                                   (uint64_t)random_below(&random, cells)};
    const double mean = area_of(&square) * (all.most - all.least);
    const int before = all.count;
    assert_int_equal(pl_rock_sites(field, NULL, &square, add, &all), PL_OK);
    square_sum += pow(all.count - before - mean, 2.0) / mean;
  }
  if (!(square_sum < 780.0 && square_sum > 450.0))
    fail_msg("counts: chi-square %g", square_sum);
  double bins = 0.0;
  for (int k = 0; k < 16; k++)
    bins += pow(all.bins[k] - all.count / 16.0, 2.0) / (all.count / 16.0);
  if (!(bins < 55.0))
    fail_msg("diameters: chi-square %g of %d", bins, all.count);
  pl_rock_field_destroy(field);
}

/* The independent judge: the ground as fine as it gets, at more points than the seat used, is
 * inside the rock all around its middle, and nowhere below its underside. Returns whether it is
 * over the rock somewhere there, which hides a part of it. */
static bool check_seat(const pl_terrain *terrain, const pl_rock *rock, const pl_rock_shape *shape) {
  bool over = false;
  enum { AROUND = 16 };
  pl_vec3 directions[AROUND];
  double heights[AROUND];
  const pl_vec3 up = rock->up;
  const pl_vec3 a = pl_vec3_unit(pl_vec3_cross(up, (pl_vec3){0.3, 0.5, 0.8})),
                b = pl_vec3_cross(up, a);
  for (int k = 0; k < AROUND; k++) {
    const double turn = 2.0 * PL_PI * k / AROUND;
    const pl_vec3 along = pl_vec3_madd(pl_vec3_scale(a, cos(turn)), sin(turn), b);
    const double outline_m =
        rock->diameter_m / pl_rock_shape_depth(shape, pl_mat3_mul_vec_t(rock->rotation, along));
    directions[k] = pl_vec3_unit(pl_vec3_madd(rock->direction, 0.35 * outline_m / RADIUS_M, along));
  }
  pl_terrain_heights(terrain, directions, AROUND, pl_terrain_level_of(terrain, 0.01), heights);
  for (int k = 0; k < AROUND; k++) {
    const pl_vec3 ground =
        pl_vec3_scale(directions[k], pl_terrain_datum_m(terrain, directions[k]) + heights[k]);
    const pl_vec3 from = pl_vec3_sub(ground, rock->center);
    const pl_vec3 own = pl_mat3_mul_vec_t(rock->rotation, from);
    const double depth = pl_rock_shape_depth(shape, pl_vec3_scale(own, 1.0 / rock->diameter_m));
    const bool outside = !(depth < 1.0);
    over = over || (outside && pl_vec3_dot(from, rock->up) > 0.0);
    if (outside && !(pl_vec3_dot(from, rock->up) > 0.0))
      fail_msg("rock %llx of %g m, burial %g, slope %g: ground at depth %g",
               (unsigned long long)rock->id, rock->diameter_m, rock->burial, rock->slope_rad,
               depth);
  }
  return over;
}

typedef struct seats {
  const pl_rock_field *field;
  const pl_terrain *terrain;
  int sites, rocks, over;
  double slope_most, burial_sum, height_sum;
} seats;

static pl_status seat(void *context, const pl_scatter_site *site) {
  seats *seats = context;
  pl_rock rock;
  pl_rock_shape shape;
  seats->sites++;
  if (!pl_rock_set(seats->field, seats->terrain, site, &rock, &shape))
    return PL_OK;
  seats->rocks++;
  seats->slope_most = fmax(seats->slope_most, rock.slope_rad);
  seats->burial_sum += rock.burial;
  seats->height_sum += rock.height_m / rock.diameter_m;
  assert_true(rock.height_m > 0.0 && rock.burial >= 0.1 && rock.burial <= 0.9);
  seats->over += check_seat(seats->terrain, &rock, &shape);
  return PL_OK;
}

static void seat_many(double strength, int count, seats *out) {
  test_random random = {.seed = 7};
  const pl_rock_frame frame = frame_of(PL_ROCKS_HAWORTH, 0.05, 50.0);
  pl_terrain *terrain = rough_moon(strength);
  pl_rock_field *field = field_of(&frame);
  *out = (seats){.field = field, .terrain = terrain};
  while (out->sites < count) {
    const int level = 16 + random_below(&random, 5); /* rocks from 2.6 m down to 0.16 m */
    const pl_rock_square square = {random_below(&random, 6), level,
                                   (uint64_t)random_below(&random, 1 << level),
                                   (uint64_t)random_below(&random, 1 << level)};
    assert_int_equal(pl_rock_sites(field, NULL, &square, seat, out), PL_OK);
  }
  pl_rock_field_destroy(field);
  pl_terrain_destroy(terrain);
}

static void test_seats(void **state) {
  (void)state;
  seats seats;
  const char *asked = getenv("PERILUNE_SEATS"); /* script/soak asks for 1e5 */
  const int count = asked != NULL ? atoi(asked) : PL_DRAWS(10000, 200);
  assert_true(count > 0);
  seat_many(1.0, count, &seats);
  assert_true(seats.over <= 1e-4 * seats.rocks);
  /* Most stay, sunk little more than drawn (0.3 on average). */
  assert_true(seats.rocks > 0.85 * seats.sites);
  const double burial = seats.burial_sum / seats.rocks, height = seats.height_sum / seats.rocks;
  if (!(burial > 0.27 && burial < 0.42 && height > 0.3 && height < 0.5))
    fail_msg("mean burial %g, height over diameter %g", burial, height);
  /* Three times as rough: many slopes are beyond repose. */
  seat_many(3.0, count / 5, &seats);
  assert_true(seats.rocks < 0.9 * seats.sites && seats.rocks > 0);
  assert_true(seats.slope_most <= 35.0 * PL_PI / 180.0);
  /* A smooth sphere. */
  seat_many(0.0, count / 5, &seats);
  assert_true(seats.rocks > 0.97 * seats.sites && seats.slope_most < 1e-3);
}

typedef struct ids {
  size_t count;
  uint64_t id[4096];
} ids;
static pl_status keep(void *context, const pl_scatter_site *site) {
  ids *ids = context;
  assert_true(ids->count < 4096);
  ids->id[ids->count++] = site->id;
  return PL_OK;
}

/* A square's rocks are those of its four parts that are large enough, with the same ids. */
static void test_levels(void **state) {
  (void)state;
  pl_rock_frame frame = frame_of(PL_ROCKS_HAWORTH, 0.3, 50.0);
  frame.law.factor = 20.0;
  pl_rock_field *field = field_of(&frame);
  static ids coarse, fine;
  const pl_rock_square square = {4, 15, 20000, 12840};
  assert_int_equal(pl_rock_sites(field, NULL, &square, keep, &coarse), PL_OK);
  for (uint64_t part = 0; part < 64; part++) {
    const pl_rock_square inner = {4, 18, 8 * 20000 + part % 8, 8 * 12840 + part / 8};
    assert_int_equal(pl_rock_sites(field, NULL, &inner, keep, &fine), PL_OK);
  }
  assert_true(coarse.count > 0 && fine.count > 4 * coarse.count);
  for (size_t k = 0; k < coarse.count; k++) {
    int found = 0;
    for (size_t n = 0; n < fine.count; n++)
      found += fine.id[n] == coarse.id[k];
    assert_int_equal(found, 1);
  }
  pl_rock_field_destroy(field);
}

/* A list has the rocks in reach, each found again by its id. */
static void test_list(void **state) {
  (void)state;
  const pl_rock_frame frame = frame_of(PL_ROCKS_VIPER, 0.2, 50.0);
  pl_rock_field *field = field_of(&frame);
  pl_terrain *terrain = rough_moon(1.0);
  /* Over an edge of the cube. */
  const pl_vec3 axis = pl_vec3_unit((pl_vec3){1.0, 1.0, 0.2});
  pl_rock *rocks;
  size_t count;
  const double reach_m = 60.0;
  assert_int_equal(pl_rock_list(field, terrain, axis, reach_m, 0.2, 50.0, &rocks, &count), PL_OK);
  const double mean = PL_PI * reach_m * reach_m * pl_rock_density(&frame.law, 0.2);
  if (!(fabs((double)count - mean) < 6.0 * sqrt(mean) + 0.1 * mean))
    fail_msg("%zu rocks, expected %g", count, mean);
  for (size_t k = 0; k < count; k++) {
    pl_rock rock;
    pl_rock_shape shape;
    assert_true(rocks[k].diameter_m >= 0.2);
    assert_true(pl_rock_find(field, terrain, rocks[k].id, &rock, &shape));
    assert_memory_equal(&rock.center, &rocks[k].center, sizeof rock.center);
    assert_true(rock.diameter_m == rocks[k].diameter_m);
    for (size_t n = 0; n < k; n++)
      assert_true(rocks[n].id != rocks[k].id);
  }
  pl_rock rock;
  pl_rock_shape shape;
  assert_false(pl_rock_find(field, terrain, 0, &rock, &shape));
  assert_false(pl_rock_find(field, terrain, UINT64_MAX, &rock, &shape));
  pl_free(rocks);
  assert_int_equal(pl_rock_list(field, terrain, axis, 1e6, 0.2, 50.0, &rocks, &count), PL_E_RANGE);
  pl_rock_field_destroy(field);
  pl_terrain_destroy(terrain);
}

/* Each point of a surface is on the ground or over it, and within reach of the rock; finer meshes
 * reach as far as coarser ones, to a tenth of the rock. */
static void check_surfaces(const pl_rock_field *field, const pl_terrain *terrain, pl_vec3 eye,
                           const uint64_t *rocks, size_t count) {
  pl_rock_surfaces far, near;
  assert_int_equal(pl_rock_surfaces_find(field, terrain, rocks, count, eye, 0.05, &far), PL_OK);
  assert_int_equal(pl_rock_surfaces_find(field, terrain, rocks, count, eye, 1e-4, &near), PL_OK);
  for (size_t k = 0; k < count; k++) {
    const pl_rock *rock = &near.rocks[k];
    double highest[2] = {0.0, 0.0};
    assert_true(rock->id == rocks[k] && far.first[k + 1] > far.first[k]);
    assert_true(near.first[k + 1] - near.first[k] > far.first[k + 1] - far.first[k]);
    for (size_t n = near.first[k]; n < near.first[k + 1]; n++) {
      const pl_vec3 p = near.points[n], up = pl_vec3_unit(p);
      const double ground_m =
          pl_terrain_datum_m(terrain, up) + pl_terrain_height(terrain, up, PL_CUBE_LEVELS - 1);
      assert_true(pl_vec3_norm(p) > ground_m - 0.02 * rock->diameter_m);
      assert_true(pl_vec3_norm(pl_vec3_sub(p, rock->center)) <
                  PL_ROCK_SHAPE_REACH * rock->diameter_m);
      highest[0] = fmax(highest[0], pl_vec3_norm(p));
    }
    for (size_t n = far.first[k]; n < far.first[k + 1]; n++)
      highest[1] = fmax(highest[1], pl_vec3_norm(far.points[n]));
    assert_true(fabs(highest[0] - highest[1]) < 0.1 * rock->diameter_m);
  }
  pl_rock_surfaces_clear(&far);
  pl_rock_surfaces_clear(&near);
}

static void test_surfaces(void **state) {
  (void)state;
  const pl_rock_frame frame = frame_of(PL_ROCKS_HAWORTH, 0.3, 5.0);
  pl_rock_field *field = field_of(&frame);
  pl_terrain *terrain = rough_moon(1.0);
  const pl_vec3 axis = pl_vec3_unit((pl_vec3){0.3, 0.5, 0.7});
  const pl_vec3 eye = pl_vec3_scale(axis, RADIUS_M + 30.0);
  pl_rock *rocks;
  size_t count;
  assert_int_equal(pl_rock_list(field, terrain, axis, 40.0, 0.5, 5.0, &rocks, &count), PL_OK);
  assert_in_range(count, 10, 1000);
  uint64_t ids[41];
  const size_t some = count < 40 ? count : 40;
  for (size_t k = 0; k < some; k++)
    ids[k] = rocks[k].id;
  check_surfaces(field, terrain, eye, ids, some);
  ids[some] = 1; /* of none, after others that have points */
  pl_rock_surfaces found;
  assert_int_equal(pl_rock_surfaces_find(field, terrain, ids, some + 1, eye, 1e-3, &found),
                   PL_E_RANGE);
  assert_int_equal(pl_rock_surfaces_find(field, terrain, ids, 0, eye, 1e-3, &found), PL_OK);
  assert_int_equal(found.first[0], 0);
  pl_rock_surfaces_clear(&found);
  pl_free(rocks);
  pl_rock_field_destroy(field);
  pl_terrain_destroy(terrain);
}

static void test_none(void **state) {
  (void)state;
  pl_rock_frame frame = frame_of(PL_ROCKS_HAWORTH, 0.05, 50.0);
  frame.law.factor = 0.0;
  pl_rock_field *field = field_of(&frame);
  static ids none;
  for (int level = 0; level < 40; level++) {
    const pl_rock_square square = {1, level, 0, 0};
    assert_int_equal(pl_rock_sites(field, NULL, &square, keep, &none), PL_OK);
  }
  assert_int_equal(none.count, 0);
  pl_rock_field_destroy(field);
}

/* A step of 40 m across 2 m: rocks at its edge are set or left out, none hangs in the air. */
static void test_cliff(void **state) {
  (void)state;
  enum { SIDE = 64 };
  static float samples[SIDE * SIDE];
  for (int k = 0; k < SIDE * SIDE; k++)
    samples[k] = k % SIDE < SIDE / 2 ? 0.0f : 40.0f;
  const pl_raster_frame raster_frame = {
      .samples = samples,
      .type = PL_RASTER_FLOAT32,
      .width = SIDE,
      .height = SIDE,
      .scale = 1.0,
      .projection = {.kind = PL_PROJECTION_ORTHOGRAPHIC,
                     .lon0_rad = 0.5,
                     .lat0_rad = 0.3,
                     .radius_m = RADIUS_M},
      .x0 = -63.0,
      .y0 = 63.0,
      .dx = 2.0,
      .dy = -2.0,
  };
  pl_raster *raster;
  assert_int_equal(pl_raster_create(&raster_frame, &raster), PL_OK);
  const pl_terrain_layer layer = {raster, PL_INTERPOLATION_BILINEAR, 0.0, 0.0};
  const pl_terrain_frame terrain_frame = {.radii_m = {RADIUS_M, RADIUS_M, RADIUS_M},
                                          .layers = &layer,
                                          .layer_count = 1,
                                          .detail = pl_terrain_detail_default(RADIUS_M)};
  pl_terrain *terrain;
  assert_int_equal(pl_terrain_create(&terrain_frame, &terrain), PL_OK);
  pl_rock_frame frame = frame_of(PL_ROCKS_HAWORTH, 0.3, 50.0);
  frame.law.factor = 10.0;
  pl_rock_field *field = field_of(&frame);
  pl_rock *rocks;
  size_t count;
  const pl_vec3 axis = {cos(0.3) * cos(0.5), cos(0.3) * sin(0.5), sin(0.3)};
  assert_int_equal(pl_rock_list(field, terrain, axis, 40.0, 0.3, 50.0, &rocks, &count), PL_OK);
  assert_true(count > 100);
  for (size_t k = 0; k < count; k++) {
    pl_rock rock;
    pl_rock_shape shape;
    assert_true(pl_rock_find(field, terrain, rocks[k].id, &rock, &shape));
    check_seat(terrain, &rock, &shape);
  }
  pl_free(rocks);
  pl_rock_field_destroy(field);
  pl_terrain_destroy(terrain);
  pl_raster_destroy(raster);
}

static void refuse(const pl_rock_frame *frame, const char *word) {
  pl_rock_field *field;
  assert_int_equal(pl_rock_field_create(frame, &field), PL_E_RANGE);
  assert_null(field);
  if (strstr(pl_error_text(), word) == NULL)
    fail_msg("\"%s\" does not name %s", pl_error_text(), word);
}

static void test_errors(void **state) {
  (void)state;
  const pl_rock_frame good = frame_of(PL_ROCKS_VIPER, 0.1, 10.0);
  pl_rock_frame frame = good;
  frame.radius_m = 0.0;
  refuse(&frame, "radius");
  frame = good, frame.min_m = 10.0;
  refuse(&frame, "least");
  frame = good, frame.max_m = 1e6;
  refuse(&frame, "must be of");
  frame = good, frame.least_burial = 0.0;
  refuse(&frame, "burial");
  frame = good, frame.most_burial = 0.95;
  refuse(&frame, "burial");
  frame = good, frame.repose_rad = (double)NAN;
  refuse(&frame, "repose_rad");
  frame = good, frame.families[PL_ROCK_SLAB] = -1.0;
  refuse(&frame, "slab");
  frame = good;
  for (int k = 0; k < PL_ROCK_FAMILIES; k++)
    frame.families[k] = 0.0;
  refuse(&frame, "families");
  frame = good, frame.law.factor = 1e4;
  refuse(&frame, "covers");
  frame = good, frame.law.kind = PL_ROCKS_GOLOMBEK, frame.law.abundance = 0.003;
  refuse(&frame, "decay_per_m");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_counts), cmocka_unit_test(test_seats),    cmocka_unit_test(test_levels),
      cmocka_unit_test(test_list),   cmocka_unit_test(test_none),     cmocka_unit_test(test_cliff),
      cmocka_unit_test(test_errors), cmocka_unit_test(test_surfaces),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
