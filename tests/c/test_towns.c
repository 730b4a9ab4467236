/* Lights of the night below a texel of their map. */
#include "harness.h"

#include <math.h>

#include "random.h"
#include "shade/towns.h"

static const double RADIUS_M = 6.4e6, SIZE_M = 2e4;

static pl_vec3 somewhere(test_random *random) {
  const double z = random_range(random, -1.0, 1.0), lon = random_range(random, -PL_PI, PL_PI);
  const double rho = sqrt(1.0 - z * z);
  return (pl_vec3){RADIUS_M * rho * cos(lon), RADIUS_M * rho * sin(lon), RADIUS_M * z};
}

/* Over a body, of dim country and of cities, near and far: so many places that their chance is
 * below 0.5 %. */
static void test_the_mean_is_the_map_s(void **state) {
  (void)state;
  static const float fractions[] = {0.02f, 1.0f}, widths[] = {0.0f, 0.2f, 0.6f};
  test_random random = {.seed = 5};
  for (size_t s = 0; s < sizeof fractions / sizeof *fractions; s++)
    for (size_t w = 0; w < sizeof widths / sizeof *widths; w++) {
      const int places = widths[w] < 0.1f ? 1500000 : 300000;
      double sum = 0.0, least = INFINITY, most = 0.0;
      for (int i = 0; i < places; i++) {
        const double x = (double)pl_towns_factor(somewhere(&random), SIZE_M,
                                                 widths[w] * (float)SIZE_M, fractions[s]);
        sum += x;
        least = fmin(least, x);
        most = fmax(most, x);
      }
      assert_true(fabs(sum / places - 1.0) < 0.01);
      assert_true(least >= 0.0 && most <= (double)PL_TOWNS_PEAK);
    }
}

/* Where towns are hidden nothing is left of them, to the bit. */
static void test_far_views_show_the_map(void **state) {
  (void)state;
  test_random random = {.seed = 6};
  for (int i = 0; i < 1000; i++)
    assert_true(pl_towns_factor(somewhere(&random), SIZE_M, 1.5f * (float)SIZE_M,
                                (float)random_unit(&random)) == 1.0f);
}

/* Two thirds of the ground have less than half of the mean light, and neighbours below a pixel are
 * as bright as each other. */
static void test_near_views_show_towns(void **state) {
  (void)state;
  test_random random = {.seed = 7};
  enum { PLACES = 20000 };
  int dark = 0;
  for (int i = 0; i < PLACES; i++) {
    pl_vec3 place = somewhere(&random);
    const float width_m = (float)random_range(&random, 100.0, 3e4);
    const float here = pl_towns_factor(place, SIZE_M, width_m, 0.3f);
    dark += pl_towns_factor(place, SIZE_M, 0.0f, 0.3f) < 0.5f;
    place = pl_vec3_add(place, (pl_vec3){0.0, 0.0, 1e-3 * (double)width_m});
    assert_true(fabsf(pl_towns_factor(place, SIZE_M, width_m, 0.3f) - here) <
                0.05f * (1.0f + here));
  }
  assert_true(dark > PLACES * 2 / 3);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      converging_unit_test(test_the_mean_is_the_map_s),
      cmocka_unit_test(test_far_views_show_the_map),
      converging_unit_test(test_near_views_show_towns),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
