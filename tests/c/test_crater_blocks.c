/* Blocks about fresh craters: profile, densities beside lists without them, ids, squares, errors.
 */
#include "harness.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "random.h"
#include "terrain/cube.h"
#include "terrain/rock_field.h"

static const double RADIUS_M = 1737400.0, AT_RIM = 20.0;

typedef struct site {
  pl_crater_field *craters;
  pl_terrain *terrain;
  pl_rock_field *plain, *blocks;
  pl_vec3 direction; /* of the crater with most blocks of some */
  double radius_m;
} site;

/* Few craters of 60 to 200 m on smooth ground, and rocks of 0.3 m and more. */
static void setup(site *s) {
  pl_crater_frame craters = pl_crater_frame_default(RADIUS_M);
  craters.law = (pl_crater_law){.kind = PL_CRATERS_POWER,
                                .surface_age_ga = 0.02,
                                .factor = 1.0,
                                .coefficient = 0.002,
                                .exponent = -2.0};
  craters.min_m = 60.0;
  craters.max_m = 200.0;
  assert_int_equal(pl_crater_field_create(&craters, &s->craters), PL_OK);
  const pl_terrain_frame ground = {.radii_m = {RADIUS_M, RADIUS_M, RADIUS_M},
                                   .craters = s->craters};
  assert_int_equal(pl_terrain_create(&ground, &s->terrain), PL_OK);
  pl_rock_frame rocks = pl_rock_frame_default(pl_terrain_radius_m(s->terrain));
  rocks.law =
      (pl_rock_law){.kind = PL_ROCKS_POWER, .factor = 1.0, .coefficient = 0.0005, .exponent = -2.0};
  rocks.min_m = 0.3;
  rocks.max_m = 4.0;
  rocks.seed = 5;
  assert_int_equal(pl_rock_field_create(&rocks, &s->plain), PL_OK);
  rocks.ejecta.at_rim = AT_RIM;
  assert_int_equal(pl_rock_field_create(&rocks, &s->blocks), PL_OK);
  pl_crater *list;
  size_t count, best = 0;
  assert_int_equal(
      pl_terrain_craters(s->terrain, (pl_vec3){0.8, 0.6, 0.0}, 5e3, 100.0, 200.0, &list, &count),
      PL_OK);
  for (size_t k = 0; k < count; k++)
    best = list[k].tau < list[best].tau ? k : best;
  assert_true(count > 0 && list[best].tau < 0.002);
  s->direction = list[best].direction;
  s->radius_m = 0.5 * list[best].diameter_m;
  pl_free(list);
}

static void teardown(site *s) {
  pl_rock_field_destroy(s->plain);
  pl_rock_field_destroy(s->blocks);
  pl_terrain_destroy(s->terrain);
  pl_crater_field_destroy(s->craters);
}

static void test_profile(void **state) {
  (void)state;
  const pl_crater_source one = {
      .direction = {1.0, 0.0, 0.0}, .radius = 1e-4, .fraction = 0.5, .most_m = 3.0};
  static const struct {
    double x, diameter_m, density;
  } rows[] = {{0.5, 1.0, 0.025}, {1.0, 1.0, 0.5}, {1.7, 1.0, 0.18393972058572117},
              {1.0, 3.1, 0.0},   {5.1, 1.0, 0.0}, {0.0, 3.0, 0.025}};
  for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
    const double angle = 2.0 * asin(0.5 * rows[k].x * one.radius) * (1.0 + 1e-12);
    const pl_vec3 d = {cos(angle), sin(angle), 0.0};
    assert_true(fabs(pl_crater_blocks_at(&one, 1, d, rows[k].diameter_m) - rows[k].density) < 1e-8);
  }
  const pl_crater_source three[3] = {one, one, one};
  assert_true(pl_crater_blocks_at(three, 3, pl_vec3_unit((pl_vec3){1.0, 1.0001e-4, 0.0}), 1.0) ==
              1.0);
}

/* Number of rocks at distances of x0 to x1 radii. */
static size_t between(const site *s, const pl_rock *list, size_t count, double x0, double x1) {
  size_t found = 0;
  for (size_t k = 0; k < count; k++) {
    const double x =
        pl_vec3_norm(pl_vec3_sub(list[k].direction, s->direction)) * RADIUS_M / s->radius_m;
    found += x >= x0 && x < x1;
  }
  return found;
}

/* Mean density of blocks there, over that of the law; of 1 m. */
static double expected(const site *s, double x0, double x1) {
  const pl_crater_blocks of = pl_rock_field_frame(s->blocks)->ejecta.craters;
  pl_crater_source *sources;
  size_t count;
  test_random random = {.seed = 3};
  double sum = 0.0;
  assert_int_equal(pl_terrain_sources(s->terrain, &of, s->direction, 0.01, &sources, &count),
                   PL_OK);
  for (int k = 0; k < 4000; k++) {
    const double x = sqrt(random_range(&random, x0 * x0, x1 * x1));
    const double turn = random_range(&random, 0.0, 2.0 * PL_PI), angle = x * s->radius_m / RADIUS_M;
    const pl_vec3 a = pl_vec3_unit(pl_vec3_cross(s->direction, (pl_vec3){0.0, 0.0, 1.0}));
    const pl_vec3 b = pl_vec3_cross(s->direction, a);
    const pl_vec3 out = pl_vec3_madd(pl_vec3_scale(a, cos(turn)), sin(turn), b);
    const pl_vec3 d = pl_vec3_unit(pl_vec3_madd(s->direction, tan(angle), out));
    sum += pl_crater_blocks_at(sources, count, d, 1.0);
  }
  pl_free(sources);
  return AT_RIM * sum / 4000.0;
}

/* Beside the same rocks without blocks: all of them stay, and more are added as stated. */
static void test_densities(void **state) {
  (void)state;
  site s;
  setup(&s);
  pl_rock *all, *plain;
  size_t count, fewer;
  const double reach_m = 6.0 * s.radius_m;
  assert_int_equal(pl_rock_list(s.blocks, s.terrain, s.direction, reach_m, 0.3, 4.0, &all, &count),
                   PL_OK);
  assert_int_equal(pl_rock_list(s.plain, s.terrain, s.direction, reach_m, 0.3, 4.0, &plain, &fewer),
                   PL_OK);
  assert_true(fewer > 100 && count > 2 * fewer);
  for (size_t k = 0, at = 0; k < fewer; k++, at++) {
    while (at < count && all[at].id != plain[k].id)
      at++;
    assert_true(at < count && all[at].diameter_m == plain[k].diameter_m);
  }
  const double area = PL_PI * s.radius_m * s.radius_m, per_m2 = 0.0005 * (1.0 / 0.09 - 1.0 / 16.0);
  static const double rings[4][2] = {{1.2, 1.8}, {1.8, 2.6}, {2.6, 3.6}, {3.6, 5.0}};
  for (int k = 0; k < 4; k++) {
    const double x0 = rings[k][0], x1 = rings[k][1];
    const double law = per_m2 * area * (x1 * x1 - x0 * x0), more = law * expected(&s, x0, x1);
    const double found =
        (double)(between(&s, all, count, x0, x1) - between(&s, plain, fewer, x0, x1));
    /* A few sites on steps of the ground are left out. */
    assert_true(fabs(found - more) < 4.0 * sqrt(more + 1.0) + 0.05 * more);
  }
  pl_free(all);
  pl_free(plain);
  teardown(&s);
}

typedef struct tally {
  const pl_rock *list;
  size_t count, found;
} tally;

static pl_status tick(void *context, const pl_scatter_site *at) {
  tally *t = context;
  for (size_t k = 0; k < t->count; k++)
    t->found += t->list[k].id == at->id;
  return PL_OK;
}

/* Each rock of a list is found by its id, and in one square of those about the crater. */
static void test_ids_and_squares(void **state) {
  (void)state;
  site s;
  setup(&s);
  pl_rock *list;
  size_t count;
  assert_int_equal(
      pl_rock_list(s.blocks, s.terrain, s.direction, 2.0 * s.radius_m, 1.0, 4.0, &list, &count),
      PL_OK);
  assert_true(count > 20);
  size_t blocks = 0;
  for (size_t k = 0; k < count; k++) {
    pl_rock rock;
    pl_rock_shape shape;
    assert_true(pl_rock_find(s.blocks, s.terrain, list[k].id, &rock, &shape));
    assert_true(rock.id == list[k].id && rock.diameter_m == list[k].diameter_m &&
                rock.center.x == list[k].center.x);
    blocks += !pl_rock_find(s.plain, s.terrain, list[k].id, &rock, &shape);
  }
  assert_true(blocks > count / 2);
  tally t = {list, count, 0};
  const int level = pl_cube_level(16.0, RADIUS_M); /* rocks of 1 m and more */
  double u[2];
  int face;
  pl_cube_locate(s.direction, &face, &u[0], &u[1]);
  const int64_t side = (int64_t)1 << level, around = 16;
  const int64_t i0 = (int64_t)((u[0] + 1.0) * 0.5 * (double)side);
  const int64_t j0 = (int64_t)((u[1] + 1.0) * 0.5 * (double)side);
  for (int64_t i = i0 - around; i <= i0 + around; i++)
    for (int64_t j = j0 - around; j <= j0 + around; j++) {
      const pl_rock_square square = {face, level, (uint64_t)i, (uint64_t)j};
      assert_int_equal(pl_rock_sites(s.blocks, s.terrain, &square, tick, &t), PL_OK);
    }
  assert_int_equal(t.found, count);
  pl_free(list);
  teardown(&s);
}

static void test_errors(void **state) {
  (void)state;
  static const pl_rock_ejecta bad[4] = {
      {-1.0, {0.3, 25.0}}, {20.0, {0.0, 25.0}}, {20.0, {0.3, 0.0}}, {2000.0, {0.3, 25.0}}};
  pl_rock_field *field;
  pl_rock_frame frame = pl_rock_frame_default(RADIUS_M);
  for (int k = 0; k < 4; k++) {
    frame.ejecta = bad[k];
    assert_int_equal(pl_rock_field_create(&frame, &field), PL_E_RANGE);
  }
  frame.ejecta = (pl_rock_ejecta){1000.0, {0.3, 25.0}};
  frame.law.factor = 10.0; /* more than half of the ground */
  assert_int_equal(pl_rock_field_create(&frame, &field), PL_E_RANGE);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_profile),
      cmocka_unit_test(test_densities),
      cmocka_unit_test(test_ids_and_squares),
      cmocka_unit_test(test_errors),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
