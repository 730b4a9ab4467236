/* Images of circles and ellipses in space, as the rims of craters, in a pinhole camera.
 *
 * The projection is exact: an ellipse entirely before the camera has an ellipse as its image, whose
 * centre is not the image of its centre. With a lens that distorts, apply the lens to points. */
#ifndef PL_ANNOTATE_RIM_IMAGE_H
#define PL_ANNOTATE_RIM_IMAGE_H

#include "math/vec.h"

/* Points centre + major cos t + minor sin t, in camera axes (x right, y down, z forward), m. */
typedef struct pl_rim {
  pl_vec3 centre, major, minor; /* semi-axes, orthogonal; major x minor points to the outside */
} pl_rim;

/* u = fx x/z + skew y/z + cx, v = fy y/z + cy. */
typedef struct pl_pinhole {
  double fx, fy, cx, cy, skew; /* pixels */
} pl_pinhole;

typedef enum pl_rim_kind {
  PL_RIM_BEHIND,  /* no point is before the near plane: nothing else is set */
  PL_RIM_PARTLY,  /* some points are behind the near plane: only the box of the others is set */
  PL_RIM_ELLIPSE, /* entirely before it; a segment if seen edge-on: semi_axes[1] is then 0 */
} pl_rim_kind;

typedef struct pl_rim_image {
  pl_rim_kind kind;
  double centre[2];    /* pixels */
  double semi_axes[2]; /* pixels, major first */
  double angle_rad;    /* of the major axis from u towards v, (-pi/2, pi/2] */
  double box[4];       /* least u and v, greatest u and v; not cut by the image */
  double facing;       /* cosine between the outward normal and the direction to the camera: below 0
                          the camera looks at the inside, as from below the ground */
} pl_rim_image;

/* `near_m`, above 0, is the distance of the plane before the camera at which rims are cut. */
pl_rim_image pl_rim_project(const pl_rim *rim, const pl_pinhole *camera, double near_m);

#endif
