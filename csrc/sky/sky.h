/* What lies behind everything, as a frame is asked for it. */
#ifndef PL_SKY_SKY_H
#define PL_SKY_SKY_H

#include "sky/backdrop.h"
#include "sky/catalogue.h"

typedef struct pl_sky {
  const pl_star_catalogue *stars; /* borrowed; NULL: none */
  pl_vec3 beta;                   /* velocity of the camera over that of light, root axes */
  pl_backdrop backdrop;
  bool by_display; /* backdrop.white is in units of the radiance that the display shows as white */
} pl_sky;

#endif
