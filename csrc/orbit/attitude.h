/* Axes derived from position and velocity: spin, orbit frames, pointing.
 *
 * Each function returns the rotation from the axes named here to the frame of its arguments. If a
 * direction that an axis needs does not exist (no motion, no orbit normal), a fixed direction
 * replaces it, so that each frame is a function of its arguments alone. The frame is discontinuous
 * there, as any such frame must be. */
#ifndef PL_ORBIT_ATTITUDE_H
#define PL_ORBIT_ATTITUDE_H

#include "base/status.h"
#include "math/rotation.h"
#include "orbit/kepler.h"

/* Fails with PL_E_RANGE, with `name` in the message, if a quaternion is zero or not finite. */
pl_status pl_attitude_check(pl_quat q, const char *name);

/* q(t) = q * rotation(axis, rate t): a constant rate about a unit axis in the object's own frame.
 * The phase is exact to the rounding of rate and t after any number of revolutions. */
pl_quat pl_attitude_spin(pl_quat q, pl_vec3 axis, double rate_rad_s, double t_s);

/* Local vertical, local horizontal frame of `state` (relative to the centre): z to the centre, y
 * opposite to the orbit normal, x along the motion. If there is no orbit normal (no motion, or
 * radial motion), the z axis of the state's frame replaces it, or x near the poles. Fails with
 * PL_E_RANGE at the centre. */
pl_status pl_attitude_lvlh(const pl_state *state, pl_quat *out);

/* RSW frame, also called RTN: x away from the centre, z along the orbit normal, y along the motion.
 * The orbit normal is that of lvlh. Fails with PL_E_RANGE at the centre. */
pl_status pl_attitude_rsw(const pl_state *state, pl_quat *out);

/* x along the velocity, y opposite to the orbit normal, z on the side of the centre; equal to lvlh
 * on a circular orbit. For radial motion the normal is a fixed axis, as for lvlh but perpendicular
 * to the velocity. Fails with PL_E_RANGE without velocity. */
pl_status pl_attitude_velocity(const pl_state *state, pl_quat *out);

/* The orbit normal of `state`, or the fixed axis that replaces it in lvlh; not normalized. */
pl_vec3 pl_attitude_normal(const pl_state *state);

/* Sun pointing: x along `aim`, z as close to `up` as possible (TRIAD). `aim` and `up` need not be
 * unit vectors. If they are parallel to within 1e-6 rad, the coordinate axis that is farthest from
 * `aim` replaces `up`. Fails with PL_E_RANGE for an aim of zero length. */
pl_status pl_attitude_aim_x(pl_vec3 aim, pl_vec3 up, pl_quat *out);

/* Target pointing: z along `aim`, y as close to -`up` as possible. This is the convention of
 * cameras, and of lvlh with the orbit normal as `up`. Otherwise as pl_attitude_aim_x. */
pl_status pl_attitude_aim_z(pl_vec3 aim, pl_vec3 up, pl_quat *out);

#endif
