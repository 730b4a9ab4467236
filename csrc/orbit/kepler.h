/* Two-body motion: a single double-precision solver for all conics, from periapsis, without
 * singular cases. */
#ifndef PL_ORBIT_KEPLER_H
#define PL_ORBIT_KEPLER_H

#include <stddef.h>

#include "base/status.h"
#include "math/vec.h"

/* Position and velocity relative to the central body; six consecutive doubles. */
typedef struct pl_state {
  pl_vec3 r_m;
  pl_vec3 v_m_s;
} pl_state;

/* A conic and the position on it at t = 0. It is a smooth function of the state for every
 * eccentricity and inclination: the plane and the line of apsides are axes instead of angles, and
 * periapsis and `alpha`, which stay finite at e = 1, define the size. Made by orbit/elements.h. */
typedef struct pl_orbit {
  double gm_m3_s2;
  double periapsis_m;       /* > 0; 0 for radial motion, with e = 1 and any sign of alpha */
  double eccentricity;      /* >= 0 */
  double alpha_m2_s2;       /* gm (1 - e)/periapsis = gm/a: its sign selects the conic */
  double since_periapsis_s; /* time since periapsis at t = 0 */
  pl_vec3 p_axis;           /* unit, to periapsis */
  pl_vec3 q_axis;           /* unit, along the motion at periapsis */
} pl_orbit;

/* Position and velocity in the orbital plane, with periapsis on +x. */
typedef struct pl_perifocal {
  double s; /* universal anomaly, s/m: E/sqrt(alpha), F/sqrt(-alpha), or D sqrt(2 q/gm) */
  double r_m, x_m, y_m;
  double vx_m_s, vy_m_s;
} pl_perifocal;

/* The Stumpff functions c_0..c_3, c_k(z) = sum_j (-z)^j/(k+2j)!. */
void pl_stumpff(double z, double c[4]);

/* Position at the universal anomaly `s` (any sign; whole periods are not removed). */
pl_perifocal pl_orbit_perifocal_at(const pl_orbit *orbit, double s);

/* Time from periapsis to the universal anomaly `s`, seconds; odd in s. */
double pl_orbit_time_at(const pl_orbit *orbit, double s);

/* Position at time `t_s` after t = 0; any sign and magnitude. Fails with PL_E_RANGE for a time that
 * is not finite. */
pl_status pl_orbit_perifocal(const pl_orbit *orbit, double t_s, pl_perifocal *out);

/* States at `count` times, in the frame of the axes. The relative error is below 1e-12 + 4 eps n
 * |t| for orbits of moderate eccentricity. Fails with PL_E_RANGE for a time that is not finite, and
 * for times at or after which radial motion has passed the centre. */
pl_status pl_orbit_states(const pl_orbit *orbit, size_t count, const double *t_s, pl_state *out);

/* Period, seconds; infinite for open conics. */
double pl_orbit_period_s(const pl_orbit *orbit);

#endif
