/* Relief and grain of the surfaces of rocks. */
#include "harness.h"

#include <math.h>

#include "random.h"
#include "terrain/rock_relief.h"

enum { ROCKS = 300, POINTS = 40 };

static const pl_mat3 SAME = {{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};

static pl_rock rock_of(uint64_t id, double diameter_m) {
  return (pl_rock){.id = id, .diameter_m = diameter_m, .rotation = SAME};
}

/* Mean square of slopes along an axis, over what the relief states; cracks add to it. */
static double stated(double diameter_m, double footprint_m) {
  test_random random = {.seed = 71};
  double squares = 0.0, variance = 0.0;
  for (int k = 0; k < ROCKS; k++)
    for (int n = 0; n < POINTS; n++) {
      const pl_rock rock = rock_of((uint64_t)k * UINT64_C(0x9e3779b97f4a7c15) + 1, diameter_m);
      const pl_vec3 normal = random_direction(&random);
      const pl_rock_relief at =
          pl_rock_relief_at(&rock, pl_vec3_scale(normal, 0.5 * diameter_m), normal, footprint_m);
      assert_true(fabs(pl_vec3_dot(at.slope, normal)) < 1e-9);
      squares += 0.5 * pl_vec3_dot(at.slope, at.slope);
      variance += at.variance;
      assert_true(fabs(at.variance + at.unseen - pl_rock_relief_variance(diameter_m)) < 1e-12);
    }
  return variance > 0.0 ? squares / variance : squares;
}

/* Slopes have the variance that is taken off the law's roughness, at any footprint. */
static void test_variance(void **state) {
  (void)state;
  for (double footprint_m = 1e-4; footprint_m < 0.02; footprint_m *= 4.0) {
    const double ratio = stated(0.5, footprint_m);
    if (!(ratio > 0.93 && ratio < 1.2))
      fail_msg("slopes over %g m: %g of the stated variance", footprint_m, ratio);
  }
  assert_true(stated(0.5, 1.0) < 1e-3);
}

/* Relief is a function of the rock: it turns with it, grows with it, and belongs to its id. */
static void test_place(void **state) {
  (void)state;
  test_random random = {.seed = 72};
  for (int k = 0; k < 50; k++) {
    const pl_rock rock = rock_of(5, 0.4);
    pl_rock turned = rock, large = rock_of(5, 4.0), other = rock_of(6, 0.4);
    turned.rotation = (pl_mat3){{{0.0, -1.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}}};
    const pl_vec3 normal = random_direction(&random), point = pl_vec3_scale(normal, 0.2);
    const pl_rock_relief a = pl_rock_relief_at(&rock, point, normal, 0.002);
    const pl_rock_relief b = pl_rock_relief_at(&turned, pl_mat3_mul_vec(turned.rotation, point),
                                               pl_mat3_mul_vec(turned.rotation, normal), 0.002);
    const pl_rock_relief c = pl_rock_relief_at(&large, pl_vec3_scale(point, 10.0), normal, 0.02);
    const pl_rock_relief d = pl_rock_relief_at(&other, point, normal, 0.002);
    assert_true(pl_vec3_norm(pl_vec3_sub(b.slope, pl_mat3_mul_vec(turned.rotation, a.slope))) <
                1e-5);
    assert_true(pl_vec3_norm(pl_vec3_sub(c.slope, a.slope)) < 1e-4);
    assert_true(pl_vec3_norm(pl_vec3_sub(d.slope, a.slope)) > 1e-6);
  }
}

/* Rocks are as bright as the ground on the mean, whatever is resolved. */
static void test_tint(void **state) {
  (void)state;
  test_random random = {.seed = 73};
  for (double footprint_m = 1e-3; footprint_m < 10.0; footprint_m *= 10.0) {
    double sum = 0.0, square = 0.0;
    for (int k = 0; k < ROCKS * POINTS; k++) {
      const pl_rock rock = rock_of((uint64_t)k + 1, 0.5);
      const double tint =
          pl_rock_tint(&rock, pl_vec3_scale(random_direction(&random), 0.25), footprint_m);
      assert_true(tint > 0.2 && tint <= PL_ROCK_TINT_MOST);
      sum += tint;
      square += (tint - 1.0) * (tint - 1.0);
    }
    assert_true(fabs(sum / (ROCKS * POINTS) - 1.0) < 0.003);
    assert_true(sqrt(square / (ROCKS * POINTS)) > 0.05);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_variance), cmocka_unit_test(test_place),
                                     cmocka_unit_test(test_tint)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
