/* What the tests of procedural textures share: random points, and means over footprints. */
#ifndef PL_TESTS_TEXTURES_H
#define PL_TESTS_TEXTURES_H

#include "random.h"

static inline pl_vec3 random_point(test_random *random, double extent) {
  const double x = random_range(random, -extent, extent);
  const double y = random_range(random, -extent, extent);
  return pl_vec3_make(x, y, random_range(random, -extent, extent));
}

/* Point `i` of `count`, spread evenly (golden angle) over the disc of `width` in the xy plane of
 * `axes` about `centre`. */
static inline pl_vec3 disc_point(pl_vec3 centre, pl_quat axes, double width, int i, int count) {
  const double angle = 2.0 * PL_PI * 0.61803398874989485 * i;
  const double radius = 0.5 * width * sqrt((i + 0.5) / count);
  const pl_vec3 offset = {radius * cos(angle), radius * sin(angle), 0.0};
  return pl_vec3_add(centre, pl_quat_rotate(axes, offset));
}

/* Mean and variance of what is added to it. */
typedef struct moments {
  double count, sum, square;
} moments;
static inline void moments_add(moments *m, double x) {
  m->count += 1.0;
  m->sum += x;
  m->square += x * x;
}
static inline double moments_mean(const moments *m) { return m->sum / m->count; }
static inline double moments_variance(const moments *m) {
  return fmax(0.0, m->square / m->count - moments_mean(m) * moments_mean(m));
}

#endif
