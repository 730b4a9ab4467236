/* The cone of directions that an ellipsoid occults.
 *
 * All computations use axes scaled by the ellipsoid's radii, in which it is the unit sphere. Lines
 * remain lines in these axes, so limb and shadow are exact for any radii. */
#ifndef PL_LIGHT_CONE_H
#define PL_LIGHT_CONE_H

#include "math/rotation.h"

typedef struct pl_cone {
  pl_mat3 scaled;  /* transforms root axes to scaled axes */
  pl_vec3 p;       /* position of the observer relative to the centre, scaled: |p| > 1 */
  double h;        /* sqrt(|p|^2 - 1): distance to the limb, scaled */
  pl_vec3 e[2];    /* unit, scaled, perpendicular to p; e[0] towards the reference direction */
  pl_vec3 limb[3]; /* root axes: limb[0] + limb[1] cos(turn) + limb[2] sin(turn) is on the limb */
} pl_cone;

/* Makes the cone of an ellipsoid with semi-axes radii_m > 0 at `pose` as seen from `point`. A turn
 * of 0 points towards the direction `reference`. Returns false if the point is inside or on the
 * ellipsoid. Rounding: coordinates of size x cause angular errors of eps x over the distance. */
bool pl_cone_make(pl_pose pose, pl_vec3 radii_m, pl_vec3 point, pl_vec3 reference, pl_cone *out);

/* Signed distance of a direction (any non-zero length) inside the limb; positive means occulted.
 * Close to the limb this is approximately the angle in scaled axes, with an error of a few eps.
 * Farther away it keeps its sign and is smooth. */
double pl_cone_depth(const pl_cone *cone, pl_vec3 direction);

/* A direction (not normalized) on the limb. Turns are right-handed about the line of sight to the
 * body's centre. */
pl_vec3 pl_cone_limb(const pl_cone *cone, double turn_rad);
/* The turn, -pi..pi, of a direction on the limb. */
double pl_cone_turn(const pl_cone *cone, pl_vec3 direction);

#endif
