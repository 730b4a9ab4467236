/* Fractal detail as a sum of octaves, at one place, without strips and caches. */
#ifndef PL_TESTS_DETAIL_SUM_H
#define PL_TESTS_DETAIL_SUM_H

#include "terrain/fractal_detail.h"

static inline int detail_finest(const pl_fractal_detail *detail, int level) {
  return level < detail->last ? level : detail->last;
}

static inline int detail_coarsest(const pl_fractal_detail *detail, int coarsest) {
  return coarsest > detail->first ? coarsest : detail->first;
}

/* Returns the sum of the octaves from `coarsest` to `level`, cut off at the bound; the bits are
 * those of adding them from the finest to the coarsest. */
static inline double detail_height(const pl_fractal_detail *detail, pl_vec3 direction, int coarsest,
                                   int level) {
  pl_detail_strip strip = {.count = 1, .x = {direction.x}, .y = {direction.y}, .z = {direction.z}};
  pl_detail_cache cache;
  pl_detail_cache_init(&cache);
  pl_detail_strip_close(&strip);
  double sum_m = 0.0;
  for (int k = detail_finest(detail, level); k >= detail_coarsest(detail, coarsest); k--)
    pl_fractal_detail_add(detail, &strip, k, level, &cache, &sum_m);
  const double deviation_m = pl_fractal_detail_deviation_m(detail, coarsest, level);
  return pl_fractal_detail_cut(sum_m, PL_DETAIL_BOUND * deviation_m);
}

/* Returns the gradient of that sum along the ground: a vector perpendicular to `direction`, rise in
 * m by distance in units of the radius; divide by the radius for a slope. */
static inline pl_vec3 detail_gradient(const pl_fractal_detail *detail, pl_vec3 direction,
                                      int coarsest, int level) {
  pl_vec3 sum = {0.0, 0.0, 0.0};
  for (int k = detail_finest(detail, level); k >= detail_coarsest(detail, coarsest); k--)
    sum = pl_vec3_add(sum, pl_fractal_detail_octave_gradient(detail, direction, k));
  return pl_vec3_madd(sum, -pl_vec3_dot(sum, direction), direction);
}

#endif
