/* Planes through discs of the ground: exact weights, the same bits in any batch, errors. */
#include "harness.h"

#include "random.h"
#include "terrain/crater_field.h"
#include "terrain/plane_fit.h"

static const double RADIUS_M = 1737400.0;

/* Of a + b x + c y the weights give (b, c), for any number of points. */
static void test_weights_are_exact_on_planes(void **state) {
  (void)state;
  test_random random = {.seed = 21};
  pl_disc disc;
  for (int points = PL_DISC_LEAST; points <= PL_DISC_MOST; points++) {
    assert_int_equal(pl_disc_init(points, &disc), PL_OK);
    const double a = random_range(&random, -1e3, 1e3), b = random_range(&random, -2.0, 2.0);
    const double c = random_range(&random, -2.0, 2.0);
    double along = 0.0, across = 0.0;
    for (int k = 0; k < points; k++) {
      const double h = a + b * disc.x[k] + c * disc.y[k];
      along += disc.of_x[k] * h;
      across += disc.of_y[k] * h;
      assert_true(hypot(disc.x[k], disc.y[k]) < 0.55);
    }
    assert_true(fabs(along - b) < 1e-10 && fabs(across - c) < 1e-10);
  }
}

static void test_errors(void **state) {
  (void)state;
  pl_disc disc;
  assert_int_equal(pl_disc_init(PL_DISC_LEAST - 1, &disc), PL_E_RANGE);
  assert_int_equal(pl_disc_init(PL_DISC_MOST + 1, &disc), PL_E_RANGE);
}

/* Places from far apart to within a part of the baseline, which are evaluated in other orders. */
static void test_batches_do_not_matter(void **state) {
  (void)state;
  enum { COUNT = 70 };
  test_random random = {.seed = 22};
  print_message("seed 22\n");
  pl_crater_frame craters = pl_crater_frame_default(RADIUS_M);
  pl_crater_field *field;
  pl_terrain *terrain;
  pl_disc disc;
  craters.min_m = 2.0;
  assert_int_equal(pl_crater_field_create(&craters, &field), PL_OK);
  const pl_terrain_frame frame = {.radii_m = {RADIUS_M, RADIUS_M, RADIUS_M},
                                  .detail = pl_terrain_detail_default(RADIUS_M),
                                  .craters = field};
  assert_int_equal(pl_terrain_create(&frame, &terrain), PL_OK);
  assert_int_equal(pl_disc_init(32, &disc), PL_OK);
  const pl_vec3 middle = random_direction(&random);
  for (double span_m = 1.0; span_m < 1e6; span_m *= 30.0) {
    pl_vec3 directions[COUNT];
    pl_plane_fit together[COUNT], alone;
    for (int k = 0; k < COUNT; k++)
      directions[k] = pl_vec3_unit(pl_vec3_madd(middle, span_m / RADIUS_M * random_unit(&random),
                                                random_direction(&random)));
    assert_int_equal(pl_plane_fits(terrain, &disc, directions, COUNT, 10.0, together), PL_OK);
    for (int k = 0; k < COUNT; k += 9) {
      assert_int_equal(pl_plane_fits(terrain, &disc, &directions[k], 1, 10.0, &alone), PL_OK);
      assert_memory_equal(&alone, &together[k], sizeof alone);
      assert_true(alone.slope_rad > 0.0 && alone.rms_m > 0.0);
    }
  }
  pl_terrain_destroy(terrain);
  pl_crater_field_destroy(field);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_weights_are_exact_on_planes),
      cmocka_unit_test(test_errors),
      cmocka_unit_test(test_batches_do_not_matter),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
