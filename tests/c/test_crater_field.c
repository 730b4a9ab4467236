/* Counts, places and ages of the craters of a field, from regions of any place and size. Random
 * places are drawn from fixed seeds; bounds on statistics lie at 4.5 standard errors or more. */
#include "harness.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "random.h"
#include "terrain/crater_cells.h"
#include "terrain/crater_field.h"
#include "terrain/crater_profile.h"

#define RADIUS_M 1000.0

static pl_crater_frame frame_of(void) {
  return (pl_crater_frame){.radius_m = RADIUS_M,
                           .law = {.kind = PL_CRATERS_POWER,
                                   .surface_age_ga = 3.5,
                                   .factor = 1.0,
                                   .coefficient = 0.08,
                                   .exponent = -2.0},
                           .seed = 7,
                           .min_m = 1.0,
                           .max_m = 150.0,
                           .diffusivity_m2_per_myr = 5.5,
                           .diffusivity_exponent = 0.9,
                           .irregularity = 1.0,
                           .model_posts = 6.0};
}

static pl_crater_field *field_of(const pl_crater_frame *frame) {
  pl_crater_field *field;
  if (pl_crater_field_create(frame, &field) != PL_OK)
    fail_msg("%s", pl_error_text());
  return field;
}

static size_t list_of(const pl_crater_field *field, pl_vec3 direction, double radius_m,
                      double min_m, double max_m, pl_crater **out) {
  size_t count;
  if (pl_crater_list(field, NULL, direction, radius_m, min_m, max_m, out, &count) != PL_OK)
    fail_msg("%s", pl_error_text());
  return count;
}

static const pl_vec3 north = {0.0, 0.0, 1.0};
#define WHOLE (4.0 * RADIUS_M)

/* 1e5 craters and more of the whole body: as many in each of 32 bins of diameter as the law says,
 * and ages uniform in the impacts. Chi-square of 32 degrees of freedom above 80 in 6e-6 of seeds.
 */
static void test_counts(void **state) {
  (void)state;
  enum { BINS = 32 };
  pl_crater_frame frame = frame_of();
  frame.min_m = PL_DRAWS(3.0, 15.0);
  pl_crater_field *field = field_of(&frame);
  pl_crater *craters;
  const size_t count = list_of(field, north, WHOLE, 0.0, INFINITY, &craters);
  const double area = 4.0 * PL_PI * RADIUS_M * RADIUS_M;
  double bins[BINS] = {0.0}, ages[BINS] = {0.0}, square = 0.0, age_square = 0.0;
  for (size_t k = 0; k < count; k++) {
    const double n = pl_crater_density(&frame.law, craters[k].diameter_m);
    const double most = pl_crater_density(&frame.law, frame.min_m);
    const double least = pl_crater_density(&frame.law, frame.max_m);
    bins[(int)fmin((most - n) / (most - least) * BINS, BINS - 1)] += 1.0;
    const double oldest = pl_crater_oldest_drawn_ga(&frame, craters[k].diameter_m);
    const double part = pl_crater_chronology(craters[k].age_ga) / pl_crater_chronology(oldest);
    assert_true(part >= 0.0 && part < 1.0 + 1e-9);
    assert_true(craters[k].tau < PL_CRATER_TAU_COUNTED + 1e-9);
    ages[(int)fmin(part * BINS, BINS - 1)] += 1.0;
  }
  const double expected =
      area *
      (pl_crater_density(&frame.law, frame.min_m) - pl_crater_density(&frame.law, frame.max_m)) /
      BINS;
  for (int bin = 0; bin < BINS; bin++) {
    square += pow(bins[bin] - expected, 2.0) / expected;
    age_square += pow(ages[bin] - (double)count / BINS, 2.0) * BINS / (double)count;
  }
  assert_true(PL_DRAWS(count > 100000, count > 2000));
  if (!(square < 80.0 && age_square < 80.0))
    fail_msg("chi-square of counts %g, of ages %g", square, age_square);
  pl_free(craters);
  pl_crater_field_destroy(field);
}

/* Patches about corners, edges and centres of the cube and the poles hold as many craters as their
 * area has; their counts are Poisson, and those of neighbours independent. */
enum { PATCHES = 200, SEEDS = 4 };
#define PATCH_M 20.0

static double count_in(const pl_crater_field *field, pl_vec3 centre) {
  pl_crater *craters;
  const size_t count = list_of(field, centre, PATCH_M, 3.0, 150.0, &craters);
  pl_free(craters);
  return (double)count;
}

static void test_patches(void **state) {
  (void)state;
  pl_crater_frame frame = frame_of();
  test_random random = {.seed = 3};
  const double mean = PL_PI * PATCH_M * PATCH_M *
                      (pl_crater_density(&frame.law, 3.0) - pl_crater_density(&frame.law, 150.0));
  double sum = 0.0, square = 0.0, product = 0.0, n = 0.0, corners = 0.0, edges = 0.0;
  for (frame.seed = 0; frame.seed < SEEDS; frame.seed++) {
    pl_crater_field *field = field_of(&frame);
    for (int k = 0; k < PL_DRAWS(PATCHES, PATCHES / 10); k++, n += 1.0) {
      const pl_vec3 a = random_direction(&random);
      const pl_vec3 side = pl_vec3_unit(pl_vec3_cross(a, random_direction(&random)));
      const double angle = 2.0 * PATCH_M / RADIUS_M + 1e-6;
      const pl_vec3 b = pl_vec3_madd(pl_vec3_scale(a, cos(angle)), sin(angle), side);
      const double first = count_in(field, a) - mean, second = count_in(field, b) - mean;
      sum += first + second;
      square += first * first + second * second;
      product += first * second;
    }
    for (int k = 0; k < 8; k++) {
      const double x = k & 1 ? 1.0 : -1.0, y = k & 2 ? 1.0 : -1.0, z = k & 4 ? 1.0 : -1.0;
      corners += count_in(field, pl_vec3_unit((pl_vec3){x, y, z})) - mean;
      edges += count_in(field, pl_vec3_unit((pl_vec3){x, y, 0.3 * z})) - mean;
    }
    pl_crater_field_destroy(field);
  }
  assert_true(fabs(sum) < 4.5 * sqrt(2.0 * n * mean));
  assert_true(fabs(square / (2.0 * n * mean) - 1.0) < 4.5 * sqrt((2.0 + 1.0 / mean) / (2.0 * n)));
  assert_true(fabs(product) < 4.5 * mean * sqrt(n));
  assert_true(fabs(corners) < 4.5 * sqrt(8.0 * SEEDS * mean));
  assert_true(fabs(edges) < 4.5 * sqrt(8.0 * SEEDS * mean));
}

static int by_id(const void *a, const void *b) {
  const uint64_t x = ((const pl_crater *)a)->id, y = ((const pl_crater *)b)->id;
  return (x > y) - (x < y);
}

/* The craters of a region are those of the whole body that lie in it: none is lost or doubled at
 * edges and corners of the cube, at the poles or at the date line. */
static void test_regions_agree(void **state) {
  (void)state;
  pl_crater_frame frame = frame_of();
  frame.min_m = 8.0;
  pl_crater_field *field = field_of(&frame);
  pl_crater *all, *some;
  const size_t count = list_of(field, north, WHOLE, 0.0, INFINITY, &all);
  for (size_t k = 1; k < count; k++)
    assert_true(all[k].id > all[k - 1].id && all[k].id < UINT64_C(1) << 63);
  const pl_vec3 centres[] = {{0, 0, 1},     {0, 0, -1},      {-1, 1e-9, 0}, {1, 1, 1},
                             {-1, -1, 1},   {1, -1, -1},     {1, 1, 0},     {0, -1, 1},
                             {0.3, 1, 0.2}, {-1, 0.99, 0.98}};
  for (size_t c = 0; c < sizeof centres / sizeof centres[0]; c++)
    for (double radius_m = 30.0; radius_m < 4.0 * RADIUS_M; radius_m *= 3.0) {
      const size_t found = list_of(field, centres[c], radius_m, 10.0, 60.0, &some);
      const pl_vec3 axis = pl_vec3_unit(centres[c]);
      size_t inside = 0;
      for (size_t k = 0; k < count; k++) {
        const double angle =
            2.0 * asin(fmin(1.0, 0.5 * pl_vec3_norm(pl_vec3_sub(all[k].direction, axis))));
        if (angle > radius_m / RADIUS_M || all[k].diameter_m < 10.0 || all[k].diameter_m >= 60.0)
          continue;
        const pl_crater *same = bsearch(&all[k], some, found, sizeof *some, by_id);
        assert_non_null(same);
        assert_memory_equal(same, &all[k], sizeof *same);
        inside++;
      }
      assert_int_equal(found, inside);
      pl_free(some);
    }
  pl_free(all);
  pl_crater_field_destroy(field);
}

static void test_no_craters(void **state) {
  (void)state;
  pl_crater_frame frame = frame_of();
  frame.law.factor = 0.0;
  pl_crater_field *field = field_of(&frame);
  pl_crater *craters;
  assert_int_equal(list_of(field, north, WHOLE, 0.0, INFINITY, &craters), 0);
  pl_free(craters);
  double height = 3.0;
  assert_int_equal(pl_crater_add_heights(field, NULL, &north, 1, 0.1, &height), PL_OK);
  assert_true(height == 3.0);
  pl_crater_field_destroy(field);
}

/* A surface that is as full as it can be: 1.54 D^-2. */
static void test_saturation(void **state) {
  (void)state;
  pl_crater_frame frame = frame_of();
  frame.law.coefficient = 1.54;
  pl_crater_field *field = field_of(&frame);
  pl_crater *craters;
  const double radius_m = PL_DRAWS(60.0, 20.0);
  const double count = (double)list_of(field, north, radius_m, 1.0, 2.0, &craters);
  const double half = sin(0.5 * radius_m / RADIUS_M);
  const double expected = 4.0 * PL_PI * RADIUS_M * RADIUS_M * half * half * 1.54 * 0.75;
  assert_true(fabs(count - expected) < 4.5 * sqrt(expected));
  pl_free(craters);
  pl_crater_field_destroy(field);
}

static double spacing(const void *context, pl_vec3 direction) {
  return direction.z > 0.0 ? *(const double *)context : (double)INFINITY;
}

/* Craters that an elevation model shows are left to it, the others are the same as without. */
static void test_model(void **state) {
  (void)state;
  pl_crater_frame frame = frame_of();
  frame.min_m = 8.0;
  pl_crater_field *field = field_of(&frame);
  const double spacing_m = 3.0;
  const pl_crater_model model = {.spacing_m = spacing, .context = &spacing_m};
  pl_crater *all, *some;
  size_t found, kept = 0;
  const size_t count = list_of(field, north, WHOLE, 0.0, INFINITY, &all);
  assert_int_equal(pl_crater_list(field, &model, north, WHOLE, 0.0, INFINITY, &some, &found),
                   PL_OK);
  for (size_t k = 0; k < count; k++) {
    const bool shown = all[k].direction.z > 0.0 && all[k].diameter_m >= 6.0 * spacing_m;
    const pl_crater *same = bsearch(&all[k], some, found, sizeof *some, by_id);
    assert_int_equal(same == NULL, shown);
    kept += !shown;
  }
  assert_int_equal(found, kept);
  assert_true(kept < count);
  pl_free(all);
  pl_free(some);
  pl_crater_field_destroy(field);
}

/* Old and small craters are shallow: d/D falls as tau grows, and stays below that of fresh ones. */
static void test_degradation(void **state) {
  (void)state;
  pl_crater_frame frame = frame_of();
  frame.min_m = 4.0;
  pl_crater_field *field = field_of(&frame);
  pl_crater *craters;
  const size_t count = list_of(field, north, 300.0, 0.0, INFINITY, &craters);
  double fresh = 0.0, old = 0.0, fresh_count = 0.0, old_count = 0.0;
  for (size_t k = 0; k < count; k++) {
    const pl_crater *c = &craters[k];
    assert_true(c->depth_m > 0.0 && c->depth_m < 0.22 * c->diameter_m);
    assert_true(c->rim_m >= 0.0 && c->rim_m < 0.8 * c->depth_m);
    assert_true(c->kept >= 0.0 && c->kept <= 1.0);
    assert_true(fabs(c->tau * 0.25 * c->diameter_m * c->diameter_m -
                     5500.0 * c->age_ga * pow(1e-3 * c->diameter_m, 0.9)) <
                1e-9 * c->age_ga * 5500.0);
    if (c->tau < 0.02)
      fresh += c->depth_m / c->diameter_m, fresh_count += 1.0;
    if (c->tau > 0.2)
      old += c->depth_m / c->diameter_m, old_count += 1.0;
  }
  assert_true(fresh_count > 5.0 && old_count > 5.0);
  assert_true(fresh / fresh_count > 0.09 && old / old_count < 0.03);
  pl_free(craters);
  pl_crater_field_destroy(field);
}

static void refuse(pl_crater_frame frame, const char *word) {
  pl_crater_field *field = NULL;
  assert_int_equal(pl_crater_field_create(&frame, &field), PL_E_RANGE);
  assert_null(field);
  if (strstr(pl_error_text(), word) == NULL)
    fail_msg("\"%s\" does not name %s", pl_error_text(), word);
}

static void test_errors(void **state) {
  (void)state;
  pl_crater_frame frame = frame_of();
  frame.law.kind = PL_CRATERS_NEUKUM_2001; /* 0.7 times saturation at 10 m, 20 times at 1 m */
  refuse(frame, "neukum_equilibrium");
  frame = frame_of(), frame.min_m = 1e-7;
  refuse(frame, "radius");
  frame = frame_of(), frame.max_m = 400.0;
  refuse(frame, "radius");
  frame = frame_of(), frame.max_m = frame.min_m;
  refuse(frame, "least below");
  frame = frame_of(), frame.ellipticity = 0.9;
  refuse(frame, "ellipticity");
  frame = frame_of(), frame.irregularity = -1.0;
  refuse(frame, "irregularity");
  frame = frame_of(), frame.diffusivity_m2_per_myr = (double)NAN;
  refuse(frame, "diffusivity");
  frame = frame_of(), frame.model_posts = 0.0;
  refuse(frame, "model_posts");
}

/* Craters of 1 cm over 10 km^2 would be 8e9: an error, neither a hang nor too few of them. */
static void test_absurd_counts(void **state) {
  (void)state;
  pl_crater_frame frame = frame_of();
  frame.radius_m = 1737400.0;
  frame.law.kind = PL_CRATERS_TRASK;
  frame.min_m = 0.01;
  frame.max_m = 300e3;
  pl_crater_field *field = field_of(&frame);
  pl_crater *craters;
  size_t count;
  assert_int_equal(pl_crater_list(field, NULL, north, 1784.0, 0.0, INFINITY, &craters, &count),
                   PL_E_RANGE);
  assert_non_null(strstr(pl_error_text(), "7.94e+09"));
  assert_null(craters);
  const pl_vec3 none = {0.0, 0.0, 0.0};
  assert_int_equal(pl_crater_list(field, NULL, none, 10.0, 0.0, 1.0, &craters, &count), PL_E_RANGE);
  pl_crater_field_destroy(field);
}

static int allowed;
static void *few(void *context, size_t size) {
  (void)context;
  return allowed-- > 0 ? malloc(size) : NULL;
}

static void test_out_of_memory(void **state) {
  (void)state;
  const pl_crater_frame frame = frame_of();
  pl_crater_field *field = NULL, *whole = field_of(&frame);
  pl_crater *craters;
  size_t count;
  double height = 0.0;
  pl_memory_hook(few, NULL);
  for (int n = 0; field == NULL; n++) {
    allowed = n;
    const pl_status status = pl_crater_field_create(&frame, &field);
    assert_int_equal(status, field == NULL ? PL_E_MEMORY : PL_OK);
  }
  allowed = 0;
  assert_int_equal(pl_crater_add_heights(whole, NULL, &north, 1, 0.1, &height), PL_E_MEMORY);
  assert_int_equal(pl_crater_list(whole, NULL, north, 50.0, 0.0, 9.0, &craters, &count),
                   PL_E_MEMORY);
  pl_memory_hook(NULL, NULL);
  pl_crater_field_destroy(field);
  pl_crater_field_destroy(whole);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_counts),        cmocka_unit_test(test_patches),
      cmocka_unit_test(test_regions_agree), cmocka_unit_test(test_no_craters),
      cmocka_unit_test(test_saturation),    cmocka_unit_test(test_model),
      cmocka_unit_test(test_degradation),   cmocka_unit_test(test_errors),
      cmocka_unit_test(test_absurd_counts), cmocka_unit_test(test_out_of_memory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
