/* Orbits by numerical integration of the equations of motion. */
#ifndef PL_ORBIT_NUMERICAL_H
#define PL_ORBIT_NUMERICAL_H

#include "orbit/force.h"

#define PL_NUMERICAL_RTOL_MIN 1e-15
#define PL_NUMERICAL_RTOL_MAX 1e-3

extern const pl_propagator_kind pl_numerical_kind;

/* Initial state, forces and tolerance. */
typedef struct pl_numerical_spec {
  pl_force_setting setting; /* epoch; gm of the centre's point mass, which always acts */
  pl_state state;           /* at the epoch, relative to the centre, ICRF axes */
  double rtol;              /* error of a step relative to the distance and to the speed */
  double surface_m;         /* the orbit ends with an error below this distance; 0: never */
  size_t force_count;
  pl_force **forces; /* in addition to the point mass; ownership passes on success */
  size_t motion_count;
  pl_propagator **motions; /* motions that forces refer to; ownership passes on success */
} pl_numerical_spec;

/* Creates a propagator whose dense output grows on demand on both sides of the epoch; thread-safe.
 * The steps depend on the spec only, so results do not depend on the requested times or their
 * order. Memory is bounded: see orbit/trail.h. Fails with PL_E_RANGE for numbers that are not
 * finite, rtol outside its limits, a gm that is not positive or a state below the surface. States
 * after the orbit has hit the surface fail with PL_E_RANGE and the time of impact in the message.
 */
pl_status pl_numerical_create(const pl_numerical_spec *spec, pl_propagator **out);

#endif
