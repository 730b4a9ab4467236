/* Clouds for tests. */
#ifndef PL_TESTS_CLOUDS_H
#define PL_TESTS_CLOUDS_H

#include "random.h"
#include "shade/clouds.h"

static inline void assert_near(double found, double expected, double tolerance) {
  if (!(fabs(found - expected) <= tolerance))
    fail_msg("%.9g is not %.9g to %.3g", found, expected, tolerance);
}

/* An even overcast. */
static inline pl_clouds overcast(double altitude_m, float depth) {
  return (pl_clouds){.altitude_m = altitude_m,
                     .thickness_m = 0.1 * altitude_m,
                     .opacity = 1.0f,
                     .depth = depth,
                     .color = {1.0f, 1.0f, 1.0f},
                     .coverage = 1.0f,
                     .softness = 0.3f,
                     .octaves = 0.0f,
                     .roughness = 0.5f,
                     .size_m = 1.0};
}

/* Any, on a body of some radius. */
static inline pl_clouds random_clouds(test_random *random, double radius_m) {
  pl_clouds out = overcast(radius_m * random_scale(random, 1e-4, 0.3),
                           (float)random_scale(random, 0.01, 100.0));
  out.turn_rad = random_range(random, -4.0, 4.0);
  out.opacity = (float)random_range(random, 0.1, 1.0);
  for (int k = 0; k < 3; k++)
    out.color[k] = (float)random_range(random, 0.5, 1.0);
  if (random_unit(random) < 0.7) {
    out.coverage = (float)random_range(random, 0.05, 0.95);
    out.softness = (float)random_scale(random, 0.1, 1.0);
    out.octaves = (float)random_range(random, 1.0, 10.0);
    out.roughness = (float)random_range(random, 0.3, 0.8);
    out.size_m = radius_m * random_scale(random, 0.05, 2.0);
    out.warp = (float)random_range(random, -0.5, 0.5);
    out.phase = (float)random_range(random, -3.0, 3.0);
    out.seed = (uint32_t)random_below(random, 1000);
  }
  return out;
}

#endif
