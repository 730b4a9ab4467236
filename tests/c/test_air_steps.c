/* The error of the integral along rays, by its steps: inside what the row `atmosphere` says. */
#include "harness.h"

#include <stdio.h>

#include "air/light_bounds.h"
#include "airs.h"

enum { AIRS = PL_DRAWS(40, 8), RAYS = PL_DRAWS(80, 30) };

static const double RADIUS = 6371e3;

/* Half from outside, many of them near the limb; half from inside. */
static pl_air_ray random_ray(test_random *random, double top, const pl_air_sun *sun) {
  const bool inside = random_unit(random) < 0.5;
  const double r =
      1.0 + (inside ? random_unit(random) * top : top + random_scale(random, 1e-3, 10.0));
  double mu = random_range(random, -1.0, 1.0);
  if (random_unit(random) < 0.6) { /* past the lowest point at such a height */
    const double low = (1.0 + top * random_range(random, -0.3, 1.0)) / r;
    mu = low < 1.0 ? -sqrt(1.0 - low * low) : mu;
  }
  pl_air_ray ray = {.origin = {0.0, 0.0, r},
                    .direction = {sqrt(1.0 - mu * mu), 0.0, mu},
                    .stretch = 1.0,
                    .end = INFINITY};
  ray.sun_cosine = (float)pl_vec3_dot(ray.direction, sun->direction);
  return ray;
}

enum { COUNT = 13 };
static const int steps[COUNT] = {1, 2, 3, 4, 5, 6, 8, 10, 12, 14, 16, 24, 32};

static void check_rays(const pl_air *air, test_random *random, double errors[COUNT]) {
  const pl_air_rule fine = pl_air_rule_make(PL_AIR_STEPS_MAX);
  for (int i = 0; i < RAYS; i++) {
    const pl_air_sun sun = {random_direction(random), 1.0, 0.00465};
    const double top = pl_air_settings_of(air)->top_m / RADIUS;
    const pl_air_ray ray = random_ray(random, top, &sun);
    const pl_air_light exact = pl_air_scatter(air, &ray, &sun, &fine, false);
    for (int k = 0; k < COUNT; k++) {
      const pl_air_rule rule = pl_air_rule_make(steps[k]);
      const pl_air_light found = pl_air_scatter(air, &ray, &sun, &rule, false);
      errors[k] = fmax(errors[k], pl_air_off_by(found.scattered, exact.scattered));
    }
  }
}

/* Random airs, each against what it says of itself. */
static void check_airs(double low, double high, uint64_t seed) {
  test_random random = {.seed = seed};
  double most[COUNT] = {0};
  for (int airs = 0; airs < AIRS; airs++) {
    double errors[COUNT] = {0};
    const pl_air_settings settings = random_air(&random, RADIUS, low, high);
    pl_air *air = air_create(&settings, RADIUS);
    const pl_air_light_bounds bounds = pl_air_light_bounds_of(air);
    check_rays(air, &random, errors);
    for (int k = 0; k < COUNT; k++)
      most[k] = fmax(most[k], errors[k] / pl_air_step_error(&bounds, steps[k]));
    pl_air_destroy(air);
  }
  for (int k = 0; k < COUNT; k++)
    print_message("%2d steps: off by up to %.2g of what is allowed\n", steps[k], most[k]);
  for (int k = 0; k < COUNT; k++)
    assert_true(most[k] <= 1.0);
}

static void test_clear(void **state) {
  (void)state;
  check_airs(1e-3, 0.4, 51);
}

static void test_hazy(void **state) {
  (void)state;
  check_airs(0.05, 0.8, 53);
}

static void test_thick(void **state) {
  (void)state;
  check_airs(0.05, 2.0, 52);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_clear),
      cmocka_unit_test(test_hazy),
      cmocka_unit_test(test_thick),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
