/* Rotation of the central body, for its gravity field and atmosphere. */
#ifndef PL_ORBIT_TURNING_H
#define PL_ORBIT_TURNING_H

#include "math/rotation.h"
#include "orbit/force.h"

/* By the IAU model of a body, or uniform about the z axis of an attitude given at the epoch. Over
 * some months the latter is more accurate for the Earth than its coarse IAU model. */
typedef struct pl_turning {
  double tdb_day, tdb_fraction;
  const pl_celestial *body; /* NULL: uniform */
  pl_quat q;                /* body-fixed to ICRF at t = 0 */
  double rate_rad_s;        /* about the body's z axis */
} pl_turning;

/* Parameters of a force that rotates with its centre. They must come first in the force's list,
 * since pl_turning_init reads its first values. */
#define PL_TURNING_PARAMETERS                                                                      \
  {"body", PL_FORCE_BODY, 0, true, "the centre's entry in the table of bodies, for how it turns"}, \
      {"q", PL_FORCE_NUMBERS, 4, true,                                                             \
       "instead of body: body-fixed to ICRF at the epoch (w, x, y, z)"},                           \
  {                                                                                                \
    "rate_rad_s", PL_FORCE_NUMBERS, 1, true, "with q: rate of turn about the body's z axis, rad/s" \
  }
#define PL_TURNING_COUNT 3

/* Initializes from the first values of a force. Fails with PL_E_ARGUMENT unless either body or q is
 * given. */
pl_status pl_turning_init(const pl_force_setting *setting, const pl_force_value *values,
                          pl_turning *out);

/* North pole at time t after the epoch: unit, ICRF. */
pl_vec3 pl_turning_pole(const pl_turning *turning, double t_s);
/* Rotation from body-fixed axes to ICRF. */
pl_mat3 pl_turning_matrix(const pl_turning *turning, double t_s);
/* Rotation rate about the pole, rad/s; for a body without its slow terms. */
double pl_turning_rate_rad_s(const pl_turning *turning);

#endif
