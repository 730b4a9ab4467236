/* The propagator `circular`: the unit circle, scaled and turned, at a constant rate. */
#ifndef PL_ORBIT_CIRCULAR_H
#define PL_ORBIT_CIRCULAR_H

#include "math/rotation.h"
#include "orbit/propagator.h"

extern const pl_propagator_kind pl_circular_kind;

/* r = q (a cos u, b sin u, 0), u = 2 pi (start + rate t), `radii_m` = (a, b, c), as Space OAISYS
 * draws its orbits. The third radius scales a circle that has no height, and so does nothing; it is
 * taken because the scale has three components there. It is no law of gravity: with a != b the
 * centre is the middle of the ellipse, and the rate is that of u. */
typedef struct pl_circle {
  pl_vec3 radii_m; /* a, b > 0 */
  pl_quat q;       /* the circle's axes to ICRF; need not be unit */
  double start_rev;
  double rate_rev_s; /* any sign; 0 stands still */
} pl_circle;

/* PL_E_RANGE for what is not finite, radii that are not positive, a zero quaternion. */
pl_status pl_circular_create(const pl_circle *circle, pl_propagator **out);

#endif
