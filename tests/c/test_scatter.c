/* Rays in special positions, and layers that reach through the body. */
#include "harness.h"

#include <math.h>

#include "airs.h"

/* A ray whose lowest point lies on the edge of the body's shadow: two places where the integrand
 * bends are one. Scattered light changes by no more than the ray does. */
static void test_bends_at_one_place(void **state) {
  (void)state;
  const double radius_m = 1e6;
  pl_air_settings settings = {.rayleigh_scattering = {1e-7, 2e-7, 3e-7},
                              .rayleigh_height_m = 2e5,
                              .mie_scattering = {1e-8, 1e-8, 1e-8},
                              .mie_extinction = {1e-8, 1e-8, 1e-8},
                              .mie_height_m = 1e5,
                              .ozone_center_m = 1e5,
                              .ozone_width_m = 1e4,
                              .top_m = 5e5};
  pl_air *air = air_create(&settings, radius_m);
  const pl_air_rule rule = pl_air_rule_make(16);
  const pl_air_sun sun = {{0.0, 0.0, 1.0}, 1.0, 0.005};
  pl_air_light found[3];
  int met = 0;
  /* lowest = (1, 0, -s): its square less 1 is that of its height over the terminator */
  for (int i = 1; i < 60; i++) {
    const double s = i / 64.0, norm = sqrt(1.0 + s * s);
    const pl_vec3 along = {s / norm, 0.0, 1.0 / norm};
    for (int k = 0; k < 3; k++) {
      const double start = -0.75, low = 1.0 + 1e-9 * (k - 1);
      const pl_air_ray ray = {.origin = {low + start * along.x, 0.0, -s * low + start * along.z},
                              .direction = along,
                              .stretch = 1.0,
                              .end = INFINITY};
      found[k] = pl_air_scatter(air, &ray, &sun, &rule, false);
      assert_true(isfinite(found[k].scattered.x) && isfinite(found[k].scattered.y) &&
                  isfinite(found[k].scattered.z));
    }
    met += found[1].scattered.z > 0.0f;
    assert_true(fabsf(found[0].scattered.z - found[1].scattered.z) <=
                1e-4f * found[1].scattered.z + 1e-9f);
  }
  assert_true(met > 20);
  pl_air_destroy(air);
}

/* Straight up, a layer of half-width w about the ground has the depth a (t - t^2 / 2w) to the top
 * t; that it begins beyond the other side of the body is no matter. */
static void test_wide_layer(void **state) {
  (void)state;
  const double radius_m = 5e3, absorption = 1e-4, top_m = 3e3;
  const double widths[] = {4e3, 9e3, 1.1e4, 3e4, 1e7};
  for (int i = 0; i < 5; i++) {
    pl_air_settings settings = {.rayleigh_height_m = 1e3,
                                .mie_height_m = 1e3,
                                .ozone_absorption = {absorption, absorption, absorption},
                                .ozone_width_m = widths[i],
                                .top_m = top_m};
    pl_air *air = air_create(&settings, radius_m);
    const pl_vec3 up = {0.0, 0.0, 1.0};
    const double depth = absorption * (top_m - 0.5 * top_m * top_m / widths[i]);
    assert_true(fabs((double)pl_air_depth(air, up, up, 1.0).y / depth - 1.0) < 1e-4);
    pl_air_destroy(air);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_bends_at_one_place),
                                     cmocka_unit_test(test_wide_layer)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
