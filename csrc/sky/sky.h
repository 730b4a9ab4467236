/* Sky of a frame: stars and background image, as requested by the configuration. */
#ifndef PL_SKY_SKY_H
#define PL_SKY_SKY_H

#include "sky/backdrop.h"
#include "sky/catalogue.h"

typedef struct pl_sky {
  const pl_star_catalogue *stars; /* borrowed; NULL: none */
  pl_vec3 beta;                   /* velocity of the camera over the speed of light, root axes */
  pl_backdrop backdrop;
  bool by_display; /* backdrop.white is relative to the radiance that the display shows as white */
} pl_sky;

#endif
