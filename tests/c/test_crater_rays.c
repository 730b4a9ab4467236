/* Rays of craters: fading, means, blocks, footprints, tiles, errors. */
#include "harness.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "random.h"
#include "terrain/crater_rays.h"
#include "terrain/cube.h"
#include "terrain/ground_tile_rays.h"

static const double RADIUS_M = 1737400.0;

/* Craters of 1 to 8 km by a power law, on a surface where their rays last. */
static pl_crater_frame bright(void) {
  pl_crater_frame frame = pl_crater_frame_default(RADIUS_M);
  frame.law = (pl_crater_law){.kind = PL_CRATERS_POWER,
                              .surface_age_ga = 3.0,
                              .factor = 1.0,
                              .coefficient = 0.015,
                              .exponent = -2.0};
  frame.min_m = 1e3;
  frame.max_m = 8e3;
  frame.seed = 11;
  frame.rays = (pl_crater_rays){.brightness = 0.6, .fade_ga = 3.0, .reach = 8.0};
  return frame;
}

static pl_crater_field *make(const pl_crater_frame *frame) {
  pl_crater_field *field;
  assert_int_equal(pl_crater_field_create(frame, &field), PL_OK);
  return field;
}

static void test_fading(void **state) {
  (void)state;
  const pl_crater_rays rays = {.brightness = 0.6, .fade_ga = 1.0, .reach = 8.0};
  assert_true(pl_crater_freshness(&rays, 5e3, 0.0) == 1.0);
  assert_true(pl_crater_freshness(&rays, 5e3, 0.5) == 0.25);
  assert_true(pl_crater_freshness(&rays, 5e3, 1.0) == 0.0);
  assert_true(pl_crater_freshness(&rays, 750.0, 0.125) == 0.25); /* a life of 0.25 Ga */
  assert_true(pl_crater_freshness(&rays, 750.0, 0.3) == 0.0);
}

/* The excess vanishes on the mean, whatever of the craters a footprint leaves. */
static void test_mean_stays(void **state) {
  (void)state;
  enum { COUNT = 6000 };
  const pl_crater_frame frame = bright();
  pl_crater_field *field = make(&frame);
  static const double footprints_m[2] = {50.0, 3e3};
  for (int f = 0; f < 2; f++) {
    test_random random = {.seed = 5};
    double sum = 0.0, squares = 0.0;
    float least = 1.0f, most = -1.0f;
    for (int k = 0; k < COUNT; k++) {
      const pl_vec3 d = random_direction(&random);
      float excess;
      assert_int_equal(pl_crater_add_rays(field, NULL, &d, 1, footprints_m[f], &excess), PL_OK);
      sum += (double)excess;
      squares += (double)(excess * excess);
      least = fminf(least, excess);
      most = fmaxf(most, excess);
    }
    const double mean = -(double)least; /* taken away where no crater is bright */
    const double deviation = sqrt(squares / COUNT), error = deviation / sqrt(COUNT);
    assert_true(mean > 0.04 && (double)most + mean <= 1.0001);
    /* Sums are cut where craters overlap, and the area of patterns is a mean of 128. */
    assert_true(fabs(sum / COUNT) < 4.0 * error + 0.05 * mean);
  }
  const pl_vec3 anywhere = {0.6, 0.0, 0.8};
  float coarse = 1.0f;
  assert_int_equal(pl_crater_add_rays(field, NULL, &anywhere, 1, 1.7e4, &coarse), PL_OK);
  assert_true(coarse == 0.0f);
  pl_crater_field_destroy(field);
}

/* Alone, in any block and order: the same bits. */
static void test_blocks(void **state) {
  (void)state;
  enum { COUNT = 400 };
  const pl_crater_frame frame = bright();
  pl_crater_field *field = make(&frame);
  test_random random = {.seed = 7};
  const pl_vec3 middle = random_direction(&random);
  pl_vec3 directions[COUNT], backwards[COUNT];
  float all[COUNT], turned[COUNT], alone;
  double spread = 0.0;
  for (int k = 0; k < COUNT; k++) {
    directions[k] =
        pl_vec3_unit(pl_vec3_madd(middle, 0.01 * random_unit(&random), random_direction(&random)));
    backwards[COUNT - 1 - k] = directions[k];
  }
  assert_int_equal(pl_crater_add_rays(field, NULL, directions, COUNT, 100.0, all), PL_OK);
  assert_int_equal(pl_crater_add_rays(field, NULL, backwards, COUNT, 100.0, turned), PL_OK);
  for (int k = 0; k < COUNT; k++) {
    assert_true(all[k] == turned[COUNT - 1 - k]);
    spread = fmax(spread, fabs((double)(all[k] - all[0])));
    if (k % 16 == 0) {
      assert_int_equal(pl_crater_add_rays(field, NULL, &directions[k], 1, 100.0, &alone), PL_OK);
      assert_true(alone == all[k]);
    }
  }
  assert_true(spread > 0.05);
  pl_crater_field_destroy(field);
}

/* The youngest crater of some is bright at its centre, by its freshness, and dark beyond its reach;
 * a model that shows it has its brightness, too. */
static double fine_m(const void *context, pl_vec3 direction) {
  (void)direction; /* everywhere the same */
  return *(const double *)context;
}

static void test_one_crater(void **state) {
  (void)state;
  pl_crater_frame frame = bright();
  frame.law.coefficient = 1e-4; /* few, which do not overlap */
  pl_crater_field *field = make(&frame);
  const pl_vec3 axis = {1.0, 0.0, 0.0};
  pl_crater *list;
  size_t count, youngest = 0;
  assert_int_equal(pl_crater_list(field, NULL, axis, 1e6, 2e3, 8e3, &list, &count), PL_OK);
  for (size_t k = 0; k < count; k++)
    if (list[k].age_ga < list[youngest].age_ga)
      youngest = k;
  assert_true(count > 10);
  const pl_crater *c = &list[youngest];
  test_random random = {.seed = 6};
  float excess, mean = 0.0f; /* taken away where no crater is bright */
  for (int k = 0; k < 200; k++) {
    const pl_vec3 d = random_direction(&random);
    assert_int_equal(pl_crater_add_rays(field, NULL, &d, 1, 10.0, &excess), PL_OK);
    mean = fmaxf(mean, -excess);
  }
  assert_int_equal(pl_crater_add_rays(field, NULL, &c->direction, 1, 10.0, &excess), PL_OK);
  const double light = pl_crater_freshness(&frame.rays, c->diameter_m, c->age_ga);
  assert_true(light > 0.5 && fabs((double)(excess + mean) - light) < 0.02);
  const double step_m = 1.0;
  const pl_crater_model model = {.spacing_m = fine_m, .context = &step_m};
  assert_int_equal(pl_crater_add_rays(field, &model, &c->direction, 1, 10.0, &excess), PL_OK);
  assert_true(excess == 0.0f);
  pl_free(list);
  pl_crater_field_destroy(field);
}

/* Tiles of two levels have the same brightness along the edge that they share. */
static void test_edges(void **state) {
  (void)state;
  enum { POSTS = PL_GROUND_TILE_POSTS };
  pl_crater_frame frame = bright();
  pl_crater_field *field = make(&frame);
  const pl_terrain_frame ground = {.radii_m = {RADIUS_M, RADIUS_M, RADIUS_M}, .craters = field};
  pl_terrain *terrain;
  assert_int_equal(pl_terrain_create(&ground, &terrain), PL_OK);
  /* A tile of level 8 west of the fine one at (34, 40) of level 9. */
  const pl_ground_tile_id coarse = {.i = 16, .j = 20, .level = 8};
  const pl_ground_tile_id fine = {.i = 34,
                                  .j = 40,
                                  .level = 9,
                                  .coarse = PL_GROUND_TILE_WEST | PL_GROUND_TILE_SOUTH_WEST |
                                            PL_GROUND_TILE_NORTH_WEST};
  struct pl_ground_rays *a, *b;
  assert_int_equal(pl_ground_rays_make(terrain, coarse, &a), PL_OK);
  assert_int_equal(pl_ground_rays_make(terrain, fine, &b), PL_OK);
  int spread = 0;
  for (int j = 0; j < POSTS; j += 2) {
    const int theirs = a->posts[j / 2 * POSTS + POSTS - 1], ours = b->posts[j * POSTS];
    assert_true(abs(theirs - ours) <= 1);
    spread = abs(ours - b->posts[0]) > spread ? abs(ours - b->posts[0]) : spread;
    if (j > 0)
      assert_true(abs(2 * b->posts[(j - 1) * POSTS] - b->posts[(j - 2) * POSTS] - ours) <= 2);
  }
  assert_true(spread > 20);
  pl_free(a);
  pl_free(b);
  pl_terrain_destroy(terrain);
  pl_crater_field_destroy(field);
}

static void test_without(void **state) {
  (void)state;
  pl_crater_frame frame = bright();
  frame.rays.brightness = 0.0;
  pl_crater_field *field = make(&frame);
  const pl_vec3 d = {0.6, 0.0, 0.8};
  float excess = 1.0f;
  assert_int_equal(pl_crater_add_rays(field, NULL, &d, 1, 10.0, &excess), PL_OK);
  assert_true(excess == 0.0f);
  pl_crater_field_destroy(field);
  static const pl_crater_rays bad[4] = {
      {-0.1, 1.0, 8.0}, {0.5, 0.0, 8.0}, {0.5, 1.0, 2.0}, {0.5, 1.0, NAN}};
  for (int k = 0; k < 4; k++) {
    frame.rays = bad[k];
    assert_int_equal(pl_crater_field_create(&frame, &field), PL_E_RANGE);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_fading), cmocka_unit_test(test_mean_stays),
      cmocka_unit_test(test_blocks), cmocka_unit_test(test_one_crater),
      cmocka_unit_test(test_edges),  cmocka_unit_test(test_without),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
