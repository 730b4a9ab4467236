/* Distortion there and back: round trips, folds, and bounds. Values against OpenCV are in Python.
 */
#include "harness.h"
#include "random.h"
#include "scene/lens.h"

static const double brown[8] = {-0.28, 0.09, 1e-3, -8e-4, -0.012, 0.01, -0.002, 1e-4};
static const double eye[4] = {-0.02, 0.004, -0.001, 1e-4};

static pl_lens lens_of(size_t model, const double *c) {
  pl_lens lens;
  assert_int_equal(pl_lens_init(&pl_lens_models[model], c, &lens), PL_OK);
  return lens;
}

static pl_vec3 random_ray(test_random *random, double angle_max) {
  const double theta = random_range(random, 0.0, angle_max), a = random_range(random, -4.0, 4.0);
  return (pl_vec3){sin(theta) * cos(a), sin(theta) * sin(a), cos(theta)};
}

/* 1e-6 pixel of a focal length of 1000 is 1e-9; rounding alone is better than 1e-12. */
static void round_trip(const pl_lens *lens, double angle_max) {
  test_random random = {.seed = 5};
  for (int i = 0; i < 20000; i++) {
    const pl_vec3 ray = random_ray(&random, angle_max);
    pl_vec3 image, back;
    assert_true(
        pl_lens_project(lens, pl_vec3_scale(ray, random_scale(&random, 1e-3, 1e9)), &image));
    assert_true(pl_lens_unproject(lens, image.x, image.y, &back));
    assert_true(pl_vec3_norm(pl_vec3_sub(back, ray)) < 1e-11);
  }
  pl_vec3 image, back;
  assert_true(pl_lens_project(lens, (pl_vec3){0, 0, 2}, &image));
  assert_true(image.x == 0.0 && image.y == 0.0);
  assert_true(pl_lens_unproject(lens, 0.0, 0.0, &back));
  assert_true(back.x == 0.0 && back.y == 0.0 && back.z == 1.0);
}

static void test_round_trips(void **state) {
  (void)state;
  const double none[8] = {0};
  pl_lens lens = lens_of(0, brown);
  round_trip(&lens, fmin(0.9, 0.98 * lens.limit_rad));
  lens = lens_of(0, none);
  round_trip(&lens, 1.4);
  lens = lens_of(1, eye);
  round_trip(&lens, 0.99 * lens.limit_rad);
  lens = lens_of(1, none);
  round_trip(&lens, 3.1);
  lens = lens_of(2, none);
  round_trip(&lens, PL_PI);
}

/* Columns are azimuths to the right, rows elevations downwards; beyond a whole turn there is
 * nothing. */
static void test_panorama(void **state) {
  (void)state;
  const double none[8] = {0};
  const pl_lens lens = lens_of(2, none);
  const struct {
    pl_vec3 ray;
    double x, y;
  } known[] = {{{1, 0, 0}, 0.5 * PL_PI, 0.0},  {{-1, 0, -1}, -0.75 * PL_PI, 0.0},
               {{0, 1, 1}, 0.0, 0.25 * PL_PI}, {{0, -3, 0}, 0.0, -0.5 * PL_PI},
               {{0, 0, -2}, PL_PI, 0.0},       {{1, sqrt(2.0), -1}, 0.75 * PL_PI, 0.25 * PL_PI}};
  pl_vec3 out;
  for (size_t k = 0; k < sizeof known / sizeof known[0]; k++) {
    assert_true(pl_lens_project(&lens, known[k].ray, &out));
    assert_true(fabs(out.x - known[k].x) < 1e-15 && fabs(out.y - known[k].y) < 1e-15);
  }
  assert_false(pl_lens_project(&lens, (pl_vec3){0, 0, 0}, &out));
  assert_true(pl_lens_unproject(&lens, -PL_PI, 0.5 * PL_PI, &out));
  assert_false(pl_lens_unproject(&lens, 3.15, 0.0, &out));
  assert_false(pl_lens_unproject(&lens, 0.0, -1.58, &out));
}

/* With k1 = -1/3 alone the radius r - r^3/3 stops to grow at r = 1: 45 degrees, radius 2/3. */
static void test_fold(void **state) {
  (void)state;
  const double folding[8] = {-1.0 / 3.0};
  const pl_lens lens = lens_of(0, folding);
  assert_true(fabs(lens.limit_rad - 0.25 * PL_PI) < 1e-9);
  assert_true(fabs(lens.limit - 2.0 / 3.0) < 1e-12);
  pl_vec3 out;
  assert_false(pl_lens_project(&lens, (pl_vec3){1.01, 0, 1}, &out));
  assert_false(pl_lens_project(&lens, (pl_vec3){0, 0, -1}, &out));
  assert_false(pl_lens_unproject(&lens, 0.0, 0.667, &out));
  assert_true(pl_lens_unproject(&lens, 0.0, 0.666, &out));
  const double bad[8] = {NAN};
  pl_lens broken;
  assert_int_equal(pl_lens_init(&pl_lens_models[0], bad, &broken), PL_E_RANGE);
}

/* Every ray of a cone that has an image has it in the bound. */
static void test_bounds(void **state) {
  (void)state;
  test_random random = {.seed = 6};
  const pl_lens lenses[3] = {lens_of(0, brown), lens_of(1, eye), lens_of(2, eye)};
  int narrow = 0;
  for (int i = 0; i < 3000; i++) {
    const pl_lens *lens = &lenses[i % 3];
    const pl_vec3 axis = random_direction(&random);
    const double half = random_scale(&random, 1e-4, 3.0);
    const pl_lens_extent e = pl_lens_bound(lens, axis, half);
    narrow += i % 3 == 2 && e.x1 - e.x0 < 1.0;
    for (int k = 0; k < 50; k++) {
      const pl_vec3 across = pl_vec3_unit(pl_vec3_cross(axis, random_direction(&random)));
      const double a = k < 25 ? half : half * random_unit(&random);
      const pl_vec3 ray = pl_vec3_madd(pl_vec3_scale(axis, cos(a)), sin(a), across);
      pl_vec3 image;
      if (!pl_lens_project(lens, ray, &image))
        continue;
      assert_true(image.x >= e.x0 - 1e-9 && image.x <= e.x1 + 1e-9);
      assert_true(image.y >= e.y0 - 1e-9 && image.y <= e.y1 + 1e-9);
    }
  }
  assert_true(narrow > 500); /* not all panoramas whole */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_round_trips),
      cmocka_unit_test(test_fold),
      cmocka_unit_test(test_panorama),
      cmocka_unit_test(test_bounds),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
