/* Pictures behind everything: an equirectangular map of the sky, or an image that fills the frame.
 */
#ifndef PL_SKY_BACKDROP_H
#define PL_SKY_BACKDROP_H

#include "geom/texture.h"
#include "scene/snapshot.h"

typedef enum pl_backdrop_kind {
  PL_BACKDROP_NONE,
  PL_BACKDROP_MAP,     /* directions in space */
  PL_BACKDROP_COVER,   /* fills the frame, its longer side cut off evenly */
  PL_BACKDROP_STRETCH, /* fills the frame, out of shape */
  PL_BACKDROP_KINDS
} pl_backdrop_kind;

typedef struct pl_backdrop {
  pl_backdrop_kind kind;
  const pl_texture *texture; /* borrowed; NULL: none */
  /* Of a map: root axes to its own, whose z is its upper edge and x its centre column; longitude
   * grows to the right, so that of the sky seen from within it is a reflection. */
  pl_mat3 from_root;
  float white[3]; /* radiance of the picture's white, W m-2 sr-1 */
} pl_backdrop;

/* Largest radiance that it has anywhere, in any band. */
double pl_backdrop_max(const pl_backdrop *backdrop);

/* Mean radiance over a pixel, filtered as well as the texture can. */
pl_vec3f pl_backdrop_radiance(const pl_backdrop *backdrop, const pl_snapshot *shot, int x, int y);

#endif
