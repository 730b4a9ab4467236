/* Free rotation of a rigid body: Euler's equations in closed form. */
#ifndef PL_ORBIT_TUMBLE_H
#define PL_ORBIT_TUMBLE_H

#include <stdbool.h>

#include "base/status.h"
#include "math/rotation.h"

/* A motion ready to be evaluated at any time. Of the principal axes, d is the one that the angular
 * momentum circles about, b the one of the middle moment, a the third. Moments and rates are scaled
 * by powers of two to a size of 1. */
typedef struct pl_tumble {
  double inertia[3];   /* about x, y, z */
  double amplitude[3]; /* of the rates: cn on a, sn on b, dn on d; signed */
  int a, b, d;         /* axes */
  bool steep;          /* how the integral is split: c > 1, or on the separatrix */
  double m, m1;        /* parameter of the elliptic functions, and 1 - m */
  double quarter;      /* K(m); infinite on the separatrix */
  double rate_s;       /* du/dt, signed; 0: a steady spin, at `spin_rad_s` */
  double start;        /* u at t = 0 */
  double turn_s;       /* precession that is linear in time */
  double weight;       /* of the integral that the rest is */
  double c;            /* its characteristic */
  double whole, half;  /* the integral to `start`, and over 2 K */
  pl_vec3 spin_rad_s;  /* rates at t = 0 */
  double scale_rad_s;  /* of rates */
  pl_quat start_q;     /* from the axes where the momentum is z, to the outer frame */
} pl_tumble;

/* A body with principal moments of inertia `inertia` (any unit, about its x, y, z) that turns at
 * `omega_rad_s`, in its own axes, and whose axes are `start` to the outer frame, at t = 0.
 * PL_E_RANGE for moments that no body has (not positive, or one larger than the sum of the others
 * beyond 1e-9), for what is not finite, and for a zero quaternion. */
pl_status pl_tumble_init(pl_vec3 inertia, pl_vec3 omega_rad_s, pl_quat start, pl_tumble *out);

/* Body axes to the outer frame, and the rates in body axes (may be NULL), at any finite time:
 * energy and angular momentum are those of t = 0 to rounding, however far; the phases are exact to
 * rounding of |omega| t. */
pl_quat pl_tumble_at(const pl_tumble *tumble, double t_s, pl_vec3 *omega_rad_s);

#endif
