/* Relief and grain of the surface of a rock that are finer than its mesh: hackly faces, pits and
 * cracks, and minerals of other colour. A function of place in the rock and of its id, without a
 * memory; of what a footprint does not resolve, the variance of slopes is told. */
#ifndef PL_TERRAIN_ROCK_RELIEF_H
#define PL_TERRAIN_ROCK_RELIEF_H

#include "terrain/rock_field.h"

typedef struct pl_rock_relief {
  pl_vec3 slope; /* gradient of the height of the surface, rise over distance, body axes */
  /* Expected variance of slopes along any one axis: of those in it, and of those that the footprint
   * does not resolve. */
  double variance, unseen;
} pl_rock_relief;

/* At a point of the surface, relative to the rock's centre in body axes, m; `normal` is that of the
 * mesh, unit. Slopes are along the surface. */
pl_rock_relief pl_rock_relief_at(const pl_rock *rock, pl_vec3 point, pl_vec3 normal,
                                 double footprint_m);

/* Returns the variance of slopes along any one axis of all relief of rocks of a diameter. */
double pl_rock_relief_variance(double diameter_m);

/* Factor on the albedo, with a mean of 1 over rocks and places. */
double pl_rock_tint(const pl_rock *rock, pl_vec3 point, double footprint_m);
/* No factor is greater. */
#define PL_ROCK_TINT_MOST 1.5

#endif
