/* How an object turns: held, spinning, or facing what it orbits. */
#ifndef PL_ORBIT_ATTITUDE_H
#define PL_ORBIT_ATTITUDE_H

#include "base/status.h"
#include "math/rotation.h"
#include "orbit/kepler.h"

/* q(t) = q * rotation(axis, rate t): a constant rate about a unit axis of the object's own frame.
 * The phase is exact to rounding of rate and t, however many turns. */
pl_quat pl_attitude_spin(pl_quat q, pl_vec3 axis, double rate_rad_s, double t_s);

/* Local vertical, local horizontal, to the frame of `state` (relative to the centre): z to the
 * centre, y against the orbit normal, x along the motion. Without an orbit normal (no motion, or
 * radial) the frame's z axis stands for it, or x near the poles. PL_E_RANGE at the centre. */
pl_status pl_attitude_lvlh(const pl_state *state, pl_quat *out);

#endif
