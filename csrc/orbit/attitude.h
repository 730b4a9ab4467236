/* Axes that follow from where an object is and how it moves: spin, orbit frames, pointing.
 *
 * All give the rotation from the axes named here to the frame of their arguments. Where a direction
 * that an axis needs does not exist (no motion, no orbit normal), a fixed one stands for it, so
 * that each frame is a function of its arguments alone; it jumps there, as any frame must. */
#ifndef PL_ORBIT_ATTITUDE_H
#define PL_ORBIT_ATTITUDE_H

#include "base/status.h"
#include "math/rotation.h"
#include "orbit/kepler.h"

/* PL_E_RANGE with a text that calls it `name` for a quaternion that is not finite, or zero. */
pl_status pl_attitude_check(pl_quat q, const char *name);

/* q(t) = q * rotation(axis, rate t): a constant rate about a unit axis of the object's own frame.
 * The phase is exact to rounding of rate and t, however many turns. */
pl_quat pl_attitude_spin(pl_quat q, pl_vec3 axis, double rate_rad_s, double t_s);

/* Local vertical, local horizontal, to the frame of `state` (relative to the centre): z to the
 * centre, y against the orbit normal, x along the motion. Without an orbit normal (no motion, or
 * radial) the frame's z axis stands for it, or x near the poles. PL_E_RANGE at the centre. */
pl_status pl_attitude_lvlh(const pl_state *state, pl_quat *out);

/* x away from the centre, z along the orbit normal, y along the motion (RSW, also RTN). The orbit
 * normal as for lvlh. PL_E_RANGE at the centre. */
pl_status pl_attitude_rsw(const pl_state *state, pl_quat *out);

/* x along the velocity, y against the orbit normal, z on the side of the centre; on a circular
 * orbit that is lvlh. For radial motion the normal is a fixed axis, as for lvlh but square to the
 * velocity. PL_E_RANGE without velocity. */
pl_status pl_attitude_velocity(const pl_state *state, pl_quat *out);

/* The orbit normal of `state`, or the fixed axis that stands for it in lvlh; not unit. */
pl_vec3 pl_attitude_normal(const pl_state *state);

/* Sun pointing: x along `aim`, z as near to `up` as it gets (TRIAD). `aim` and `up` need not be
 * unit. When they are parallel to 1e-6 rad, the coordinate axis that is farthest from `aim` stands
 * for `up`. PL_E_RANGE for an aim of no length. */
pl_status pl_attitude_aim_x(pl_vec3 aim, pl_vec3 up, pl_quat *out);

/* Target pointing: z along `aim`, y as near to -`up` as it gets, as a camera looks and as lvlh with
 * the orbit normal for `up`. Otherwise as pl_attitude_aim_x. */
pl_status pl_attitude_aim_z(pl_vec3 aim, pl_vec3 up, pl_quat *out);

#endif
