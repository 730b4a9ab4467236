/* A stream of random numbers for tests, from the core's own generator. */
#ifndef PL_TESTS_RANDOM_H
#define PL_TESTS_RANDOM_H

#include "math/philox.h"
#include "math/rotation.h"

typedef struct test_random {
  uint64_t seed, count;
} test_random;

/* Uniform in [0, 1). */
static inline double random_unit(test_random *random) {
  const uint64_t key[2] = {random->seed, 0x7465737473u}, counter[4] = {random->count++, 0, 0, 0};
  uint64_t words[4];
  pl_philox(key, counter, words);
  return (double)(words[0] >> 11) * 0x1p-53;
}
static inline double random_range(test_random *random, double low, double high) {
  return low + (high - low) * random_unit(random);
}
/* Log-uniform. */
static inline double random_scale(test_random *random, double low, double high) {
  return low * pow(high / low, random_unit(random));
}
static inline int random_below(test_random *random, int count) {
  return (int)(random_unit(random) * count);
}
static inline pl_vec3 random_direction(test_random *random) {
  const double z = random_range(random, -1.0, 1.0), a = random_range(random, -PL_PI, PL_PI);
  const double r = sqrt(fmax(0.0, 1.0 - z * z));
  return (pl_vec3){r * cos(a), r * sin(a), z};
}
static inline pl_quat random_rotation(test_random *random) {
  return pl_quat_axis_angle(random_direction(random), random_range(random, -PL_PI, PL_PI));
}

#endif
