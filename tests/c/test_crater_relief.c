/* Relief of a field of craters against a plain sum over a list of them; its bits, continuity and
 * filter. */
#include "harness.h"

#include <string.h>

#include "base/memory.h"
#include "random.h"
#include "terrain/crater_cells.h"

#define RADIUS_M 1000.0

static pl_crater_frame frame_of(void) {
  return (pl_crater_frame){.radius_m = RADIUS_M,
                           .law = {.kind = PL_CRATERS_POWER,
                                   .surface_age_ga = 3.5,
                                   .factor = 1.0,
                                   .coefficient = 0.08,
                                   .exponent = -2.0},
                           .seed = 11,
                           .min_m = 2.0,
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

static void add(const pl_crater_field *field, const pl_vec3 *directions, size_t count,
                double footprint_m, double *heights) {
  memset(heights, 0, count * sizeof *heights);
  assert_int_equal(pl_crater_add_heights(field, NULL, directions, count, footprint_m, heights),
                   PL_OK);
}

static double height(const pl_crater_field *field, pl_vec3 direction, double footprint_m) {
  double value;
  add(field, &direction, 1, footprint_m, &value);
  return value;
}

/* A point at a distance (m) and azimuth from another. */
static pl_vec3 beside(pl_vec3 from, double distance_m, double azimuth) {
  const pl_vec3 other = fabs(from.x) < 0.5 ? (pl_vec3){1, 0, 0} : (pl_vec3){0, 1, 0};
  const pl_vec3 a = pl_vec3_unit(pl_vec3_cross(from, other)), b = pl_vec3_cross(from, a);
  const pl_vec3 side = pl_vec3_madd(pl_vec3_scale(a, cos(azimuth)), sin(azimuth), b);
  const double angle = distance_m / RADIUS_M;
  return pl_vec3_madd(pl_vec3_scale(from, cos(angle)), sin(angle), side);
}

static double distance_m(pl_vec3 a, pl_vec3 b) {
  return RADIUS_M * 2.0 * asin(0.5 * pl_vec3_norm(pl_vec3_sub(a, b)));
}

/* The sum by its definition, for round craters without harmonics. */
static double plain_sum(const pl_crater *craters, size_t count, const pl_crater_shapes *shapes,
                        pl_vec3 at) {
  double sum = 0.0;
  for (size_t k = 0; k < count; k++) {
    const pl_crater *c = &craters[k];
    const double x = distance_m(c->direction, at) / (0.5 * c->diameter_m);
    if (x >= PL_CRATER_REACH)
      continue;
    float profile[PL_CRATER_KNOTS];
    const pl_crater_dimensions fresh = pl_crater_fresh(c->diameter_m);
    pl_crater_profile(shapes, &fresh, c->tau, profile);
    double z = pl_crater_profile_height(profile, x);
    for (size_t m = 0; m < count; m++) {
      const pl_crater *y = &craters[m];
      const double ratio = log2(y->diameter_m / c->diameter_m) + 0.5;
      const double apart = distance_m(y->direction, at) / (0.5 * y->diameter_m);
      if (ratio <= 0.0 || apart >= 1.3 || y->age_ga >= c->age_ga)
        continue;
      const double s = fmin(ratio, 1.0), t = fmin(fmax((apart - 1.0) / 0.3, 0.0), 1.0);
      z *= 1.0 - s * s * (3.0 - 2.0 * s) * (1.0 - t * t * (3.0 - 2.0 * t));
    }
    sum += z;
  }
  return sum;
}

/* At the pole, the date line, edges and corners of the cube, and elsewhere. */
static const pl_vec3 places[] = {{0, 0, 1}, {-1, 1e-9, 0}, {1, 1, 1},     {-1, -1, 1},
                                 {1, 1, 0}, {0, -1, 1},    {0.3, 1, 0.2}, {-0.2, -0.9, -0.4}};
enum { PLACES = sizeof places / sizeof places[0] };

static void test_against_plain_sum(void **state) {
  (void)state;
  pl_crater_frame frame = frame_of();
  frame.irregularity = 0.0;
  pl_crater_field *field = field_of(&frame);
  pl_crater_shapes *shapes;
  assert_int_equal(pl_crater_shapes_create(&shapes), PL_OK);
  test_random random = {.seed = 5};
  double greatest = 0.0;
  for (int place = 0; place < PL_DRAWS(PLACES, 1); place++) {
    const pl_vec3 centre = pl_vec3_unit(places[place]);
    pl_crater *craters;
    size_t count;
    /* All that touch: the largest reach 300 m and are erased by others 100 m on. */
    assert_int_equal(pl_crater_list(field, NULL, centre, 420.0, 0.0, INFINITY, &craters, &count),
                     PL_OK);
    for (int k = 0; k < PL_DRAWS(30, 2); k++) {
      const pl_vec3 at =
          beside(centre, random_range(&random, 0.0, 8.0), random_range(&random, 0.0, 6.28));
      const double expected = plain_sum(craters, count, shapes, at);
      greatest = fmax(greatest, fabs(expected));
      if (!(fabs(height(field, at, 0.1) - expected) < 2e-4))
        fail_msg("%g, expected %g", height(field, at, 0.1), expected);
    }
    pl_free(craters);
  }
  assert_true(greatest > PL_DRAWS(1.0, 0.01));
  pl_crater_shapes_destroy(shapes);
  pl_crater_field_destroy(field);
}

/* A point has the same bits alone, and in blocks of any size and order. */
static void test_same_bits(void **state) {
  (void)state;
  enum { N = 24 };
  pl_crater_frame frame = frame_of();
  frame.ellipticity = 0.3;
  pl_crater_field *field = field_of(&frame);
  for (int place = 0; place < PLACES; place++) {
    pl_vec3 directions[N], some[N];
    double heights[N], others[N];
    for (int k = 0; k < N; k++)
      directions[k] = beside(pl_vec3_unit(places[place]), 0.7 * k, 2.4 * k);
    add(field, directions, N, 0.4, heights);
    for (int k = 0; k < N; k++)
      some[k] = directions[(k * 7 + 3) % N];
    add(field, some, N, 0.4, others);
    for (int k = 0; k < N; k++)
      assert_true(others[k] == heights[(k * 7 + 3) % N]);
    for (int k = 0; k < N; k += 5)
      assert_true(height(field, directions[k], 0.4) == heights[k]);
    /* With one at the other side of the body all craters are gathered. */
    some[0] = directions[1];
    some[1] = pl_vec3_scale(directions[1], -1.0);
    if (place == 0) {
      add(field, some, 2, 12.0, others);
      assert_true(others[0] == height(field, directions[1], 12.0));
    }
  }
  pl_crater_field_destroy(field);
}

/* Points all over the Moon in one call, which together touch 1e12 craters. */
static void test_wide_blocks(void **state) {
  (void)state;
  enum { N = 12 };
  const pl_crater_frame frame = pl_crater_frame_default(1737400.0);
  pl_crater_field *field = field_of(&frame);
  test_random random = {.seed = 2};
  pl_vec3 directions[N];
  double heights[N];
  for (int k = 0; k < N; k++)
    directions[k] = random_direction(&random);
  add(field, directions, N, 0.0, heights);
  for (int k = 0; k < N; k++)
    assert_true(heights[k] == height(field, directions[k], 0.0));
  pl_crater_field_destroy(field);
}

/* The same point is as high after any other step towards it: no seam at edges, corners, poles. */
static void test_continuous(void **state) {
  (void)state;
  pl_crater_frame frame = frame_of();
  pl_crater_field *field = field_of(&frame);
  double steepest = 0.0;
  for (int place = 0; place < PLACES; place++)
    for (int way = 0; way < PL_DRAWS(8, 1); way++) {
      enum { STEPS = 400 };
      static pl_vec3 directions[STEPS];
      static double heights[STEPS];
      for (int k = 0; k < STEPS; k++)
        directions[k] = beside(pl_vec3_unit(places[place]), 0.005 * (k - STEPS / 2), 0.8 * way);
      add(field, directions, STEPS, 0.1, heights);
      for (int k = 1; k < STEPS; k++)
        steepest = fmax(steepest, fabs(heights[k] - heights[k - 1]) / 0.005);
    }
  assert_true(steepest > 0.02 && steepest < 1.5);
  pl_crater_field_destroy(field);
}

/* Craters come in smoothly as the footprint falls, and none is left at great footprints. */
static void test_footprint(void **state) {
  (void)state;
  pl_crater_frame frame = frame_of();
  pl_crater_field *field = field_of(&frame);
  const pl_vec3 at = pl_vec3_unit((pl_vec3){0.3, 1.0, 0.2});
  double before = height(field, at, 100.0);
  assert_true(before == 0.0);
  double most = 0.0;
  for (double footprint = 100.0; footprint > 0.4; footprint *= 0.995) {
    const double now = height(field, at, footprint);
    most = fmax(most, fabs(now - before) / footprint);
    before = now;
  }
  assert_true(most > 0.0 && most < 0.02);
  /* From 4 footprints a diameter on, nothing changes. */
  assert_true(height(field, at, 0.5) == height(field, at, 0.01));
  pl_crater_field_destroy(field);
}

/* The deepest fresh crater that stands alone: its floor and rim are those of its list entry. */
static void test_one_crater(void **state) {
  (void)state;
  pl_crater_frame frame = frame_of();
  frame.law.coefficient = 2e-4;
  frame.min_m = 20.0;
  frame.irregularity = 0.0;
  frame.ellipticity = 0.4;
  frame.diffusivity_m2_per_myr = 1e-3;
  pl_crater_field *field = field_of(&frame);
  pl_crater *craters;
  size_t count, alone = 0;
  assert_int_equal(
      pl_crater_list(field, NULL, (pl_vec3){0, 0, 1}, 4000.0, 0.0, INFINITY, &craters, &count),
      PL_OK);
  for (size_t k = 0; k < count; k++) {
    const pl_crater *c = &craters[k];
    bool free_of_others = true;
    for (size_t m = 0; m < count; m++)
      free_of_others &= m == k || distance_m(c->direction, craters[m].direction) >
                                      4.0 * craters[m].diameter_m + c->diameter_m;
    if (!free_of_others)
      continue;
    alone++;
    assert_true(c->kept == 1.0);
    /* The rim of an ellipse lies at both of its axes; its area is that of the circle. */
    const pl_vec3 minor = pl_vec3_cross(c->direction, c->major);
    const double root = sqrt(c->axis_ratio), radius = 0.5 * c->diameter_m / RADIUS_M;
    const pl_vec3 a =
        pl_vec3_madd(pl_vec3_scale(c->direction, cos(radius / root)), sin(radius / root), c->major);
    const pl_vec3 b =
        pl_vec3_madd(pl_vec3_scale(c->direction, cos(radius * root)), sin(radius * root), minor);
    const double floor = height(field, c->direction, 1.0), rim = height(field, a, 1.0);
    assert_true(fabs(floor - (c->rim_m - c->depth_m)) < 0.01 * c->depth_m);
    assert_true(fabs(rim - c->rim_m) < 0.1 * c->rim_m);
    assert_true(fabs(rim - height(field, b, 1.0)) < 0.02 * c->rim_m);
    assert_true(fabs(c->depth_m / pl_crater_fresh(c->diameter_m).depth_m - 1.0) < 0.02);
  }
  assert_true(alone > 3);
  pl_free(craters);
  pl_crater_field_destroy(field);
}

/* A younger crater removes older ones of its size or less within its rim, wholly from 1.41 times
 * their diameter on, and none of those that are as much larger. */
static void test_erasure(void **state) {
  (void)state;
  assert_true(pl_crater_erasure(1.42, 1.0) == 1.0);
  assert_true(pl_crater_erasure(0.70, 1.0) == 0.0);
  assert_true(fabs(pl_crater_erasure(1.0, 1.0) - 0.5) < 1e-12);
  assert_true(pl_crater_erasure_at(0.99 * 0.99, 1.0) == 1.0);
  assert_true(pl_crater_erasure_at(1.31 * 1.31, 1.0) == 0.0);
  assert_true(fabs(pl_crater_erasure_at(1.15 * 1.15, 1.0) - 0.5) < 1e-12);
  /* Of two of the same age exactly one is the younger. */
  assert_true(pl_crater_younger(1.0, 5, 1.0, 4) && !pl_crater_younger(1.0, 4, 1.0, 5));
  assert_true(pl_crater_younger(0.9, 4, 1.0, 5) && !pl_crater_younger(1.0, 4, 1.0, 4));
}

/* Bounds hold what any point has, and are not much wider than the largest craters. */
static void test_bounds(void **state) {
  (void)state;
  pl_crater_frame frame = frame_of();
  pl_crater_field *field = field_of(&frame);
  double low, high, least = 0.0, most = 0.0;
  pl_crater_bounds(field, INFINITY, &low, &high);
  test_random random = {.seed = 8};
  for (int k = 0; k < PL_DRAWS(3000, 50); k++) {
    const double z = height(field, random_direction(&random), 1.0);
    least = fmin(least, z);
    most = fmax(most, z);
  }
  assert_true(low < least && high > most);
  assert_true(low > -80.0 && high < 40.0);
  double low_small, high_small;
  pl_crater_bounds(field, 10.0, &low_small, &high_small);
  assert_true(low_small > 0.2 * low && high_small < 0.2 * high && low_small < 0.0);
  pl_crater_field_destroy(field);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_against_plain_sum), cmocka_unit_test(test_same_bits),
      cmocka_unit_test(test_wide_blocks),       cmocka_unit_test(test_continuous),
      cmocka_unit_test(test_footprint),         cmocka_unit_test(test_one_crater),
      cmocka_unit_test(test_erasure),           cmocka_unit_test(test_bounds),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
