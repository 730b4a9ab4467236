/* The propagator `circular`: a scaled and rotated unit circle, traversed at a constant rate. */
#ifndef PL_ORBIT_CIRCULAR_H
#define PL_ORBIT_CIRCULAR_H

#include "math/rotation.h"
#include "orbit/propagator.h"

extern const pl_propagator_kind pl_circular_kind;

/* r = q (a cos u, b sin u, 0), u = 2 pi (start + rate t), `radii_m` = (a, b, c), as Space OAISYS
 * defines its orbits. The third radius has no effect, since it scales a circle without height; it
 * is accepted because the scale has three components in Space OAISYS. The motion does not follow
 * from gravity: with a != b the parent is at the centre of the ellipse, and the rate is that of u.
 */
typedef struct pl_circle {
  pl_vec3 radii_m; /* a, b > 0 */
  pl_quat q;       /* circle's axes to ICRF; need not be unit */
  double start_rev;
  double rate_rev_s; /* any sign; 0: at rest */
} pl_circle;

/* Fails with PL_E_RANGE for values that are not finite, radii that are not positive or a zero
 * quaternion. */
pl_status pl_circular_create(const pl_circle *circle, pl_propagator **out);

#endif
