/* Orbits by numerical integration of the equations of motion. */
#ifndef PL_ORBIT_NUMERICAL_H
#define PL_ORBIT_NUMERICAL_H

#include "orbit/force.h"

#define PL_NUMERICAL_RTOL_MIN 1e-15
#define PL_NUMERICAL_RTOL_MAX 1e-3

extern const pl_propagator_kind pl_numerical_kind;

/* What moves, and how well to follow it. */
typedef struct pl_numerical_spec {
  pl_force_setting setting; /* epoch; gm of the centre's point mass, which always acts */
  pl_state state;           /* at the epoch, relative to the centre, ICRF axes */
  double rtol;              /* error of a step relative to distance and to speed */
  double surface_m;         /* the orbit ends with an error below this distance; 0: never */
  size_t force_count;
  pl_force **forces; /* besides the point mass; each taken over on success */
  size_t motion_count;
  pl_propagator **motions; /* what the forces refer to; each taken over on success */
} pl_numerical_spec;

/* A propagator with dense output that grows on demand to both sides of the epoch; thread-safe. The
 * steps depend on the spec alone, so results do not depend on the times asked for nor their order.
 * Memory is bounded: see orbit/trail.h. Errors: PL_E_RANGE for numbers that are not finite, rtol
 * outside its limits, a gm that is not positive, a state below the surface. States at times after
 * the orbit has met the surface are PL_E_RANGE with the time of it in the text. */
pl_status pl_numerical_create(const pl_numerical_spec *spec, pl_propagator **out);

#endif
