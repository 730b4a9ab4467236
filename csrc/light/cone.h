/* The cone of directions in which an ellipsoid hides what is behind it.
 *
 * Everything happens in axes scaled by the ellipsoid's radii, where it is the unit sphere: lines
 * stay lines there, so limb and shadow are exact for any axes. */
#ifndef PL_LIGHT_CONE_H
#define PL_LIGHT_CONE_H

#include "math/rotation.h"

typedef struct pl_cone {
  pl_mat3 scaled;  /* root axes to the scaled ones */
  pl_vec3 p;       /* the observer from the centre, scaled: |p| > 1 */
  double h;        /* sqrt(|p|^2 - 1): to the limb, scaled */
  pl_vec3 e[2];    /* unit, scaled, across p; e[0] towards the reference direction */
  pl_vec3 limb[3]; /* root axes: limb[0] + limb[1] cos(turn) + limb[2] sin(turn) is on the limb */
} pl_cone;

/* Of an ellipsoid of semi-axes radii_m > 0 at `pose` as seen from `point`; turn 0 is towards the
 * direction `reference`. False if the point is inside or on the ellipsoid. Errors: coordinates of
 * size x make angles wrong by eps x over the distance. */
bool pl_cone_make(pl_pose pose, pl_vec3 radii_m, pl_vec3 point, pl_vec3 reference, pl_cone *out);

/* How far a direction, of any length but 0, is inside the limb (positive: hidden): near the limb
 * about the angle in scaled axes; error a few eps. Further off it keeps its sign and is smooth. */
double pl_cone_depth(const pl_cone *cone, pl_vec3 direction);

/* A direction (not unit) on the limb. Turns go right-handed about the direction to the body. */
pl_vec3 pl_cone_limb(const pl_cone *cone, double turn_rad);
/* The turn, -pi..pi, at which a direction on the limb is. */
double pl_cone_turn(const pl_cone *cone, pl_vec3 direction);

#endif
