/* Torque-free rotation of a rigid body: closed-form solution of Euler's equations. */
#ifndef PL_ORBIT_TUMBLE_H
#define PL_ORBIT_TUMBLE_H

#include <stdbool.h>

#include "base/status.h"
#include "math/rotation.h"

/* A rotation that can be evaluated at any time. Of the principal axes, d is the one around which
 * the angular momentum circulates, b is the one of the intermediate moment, and a is the third.
 * Moments and rates are scaled by powers of two to the order of 1. */
typedef struct pl_tumble {
  double inertia[3];   /* about x, y, z */
  double amplitude[3]; /* of the rates: cn on a, sn on b, dn on d; signed */
  int a, b, d;         /* axes */
  bool steep;          /* selects the split of the integral: c > 1, or on the separatrix */
  double m, m1;        /* parameter of the elliptic functions, and 1 - m */
  double quarter;      /* K(m); infinite on the separatrix */
  double rate_s;       /* du/dt, signed; 0: a steady spin at `spin_rad_s` */
  double start;        /* u at t = 0 */
  double turn_s;       /* rate of the precession that is linear in time */
  double weight;       /* factor of the elliptic integral in the remaining precession */
  double c;            /* characteristic of that integral */
  double whole, half;  /* the integral up to `start`, and over 2 K */
  pl_vec3 spin_rad_s;  /* rates at t = 0 */
  double scale_rad_s;  /* scale of the rates */
  pl_quat start_q;     /* from axes with the angular momentum along z to the outer frame */
} pl_tumble;

/* Initializes the rotation of a body with principal moments of inertia `inertia` (any unit, about
 * its x, y, z axes). At t = 0 its angular velocity is `omega_rad_s`, in body axes, and `start` is
 * the rotation from body axes to the outer frame. Fails with PL_E_RANGE for physically impossible
 * moments (not positive, or one larger than the sum of the others by more than 1e-9), for values
 * that are not finite and for a zero quaternion. */
pl_status pl_tumble_init(pl_vec3 inertia, pl_vec3 omega_rad_s, pl_quat start, pl_tumble *out);

/* Rotation from body axes to the outer frame, and the angular velocity in body axes (may be NULL),
 * at any finite time. Energy and angular momentum equal those at t = 0 to rounding at all times;
 * the phases are exact to the rounding of |omega| t. */
pl_quat pl_tumble_at(const pl_tumble *tumble, double t_s, pl_vec3 *omega_rad_s);

#endif
