/* Background images: an equirectangular map of the sky, or an image that fills the frame. */
#ifndef PL_SKY_BACKDROP_H
#define PL_SKY_BACKDROP_H

#include "geom/texture.h"
#include "scene/snapshot.h"

typedef enum pl_backdrop_kind {
  PL_BACKDROP_NONE,
  PL_BACKDROP_MAP,     /* by direction in space */
  PL_BACKDROP_COVER,   /* fills the frame without distortion; the longer side is cropped evenly */
  PL_BACKDROP_STRETCH, /* fills the frame; may be distorted */
  PL_BACKDROP_KINDS
} pl_backdrop_kind;

typedef struct pl_backdrop {
  pl_backdrop_kind kind;
  const pl_texture *texture; /* borrowed; NULL: none */
  /* For a map: rotation from root axes to its own, in which z is the direction of the upper edge
   * and x that of the centre column. Longitude increases to the right: the map is mirrored relative
   * to the sky as seen from inside. */
  pl_mat3 from_root;
  float white[3]; /* radiance of white in the image, W m-2 sr-1 */
} pl_backdrop;

/* Maximum radiance over the image, in any band. */
double pl_backdrop_max(const pl_backdrop *backdrop);

/* Mean radiance over a pixel, with the best filter of the texture. */
pl_vec3f pl_backdrop_radiance(const pl_backdrop *backdrop, const pl_snapshot *shot, int x, int y);

#endif
