/* Atmospheres of all sorts. */
#ifndef PL_TESTS_AIRS_H
#define PL_TESTS_AIRS_H

#include "air/air.h"
#include "random.h"

/* Depths of gas and haze straight up in low..high; scale heights of 1e-5 to 0.1 of the radius. */
static inline pl_air_settings random_air(test_random *random, double radius_m, double low,
                                         double high) {
  const double height_m = radius_m * random_scale(random, 1e-5, 0.1);
  pl_air_settings s = {
      .rayleigh_height_m = height_m,
      .mie_height_m = height_m * random_range(random, 0.1, 1.0),
      .ozone_center_m = 3.0 * height_m,
      .ozone_width_m = 2.0 * height_m,
      .top_m = height_m * random_range(random, 8.0, 14.0),
  };
  if (random_unit(random) < 0.5) { /* with layers above */
    s.rayleigh_upper_from_m = height_m * random_range(random, 0.5, 4.0);
    s.rayleigh_upper_height_m = height_m * random_range(random, 0.5, 1.5);
    s.mie_upper_from_m = s.mie_height_m * random_range(random, 1.0, 5.0);
    s.mie_upper_height_m = s.mie_height_m * random_range(random, 0.5, 3.0);
  }
  const double gas = random_scale(random, low, high), haze = random_scale(random, low, high);
  const double fraction = random_range(random, 0.5, 1.0), g = random_range(random, -0.3, 0.8);
  for (int k = 0; k < 3; k++) {
    const double blue = random_range(random, 0.2, 1.0);
    s.rayleigh_scattering[k] = blue * gas / s.rayleigh_height_m;
    s.mie_extinction[k] = haze / s.mie_height_m;
    s.mie_scattering[k] = fraction * s.mie_extinction[k];
    s.mie_g[k] = g;
    s.ozone_absorption[k] = random_unit(random) * 0.2 * gas / height_m;
    s.ground_albedo[k] = random_unit(random);
  }
  return s;
}

static inline pl_air *air_create(const pl_air_settings *settings, double radius_m) {
  pl_air *air;
  const pl_status status = pl_air_create(settings, radius_m, &air);
  if (status != PL_OK)
    fail_msg("%s", pl_error_text());
  return air;
}

#endif
