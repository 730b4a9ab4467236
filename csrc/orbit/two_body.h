/* The propagator `kepler`: two-body motion on any conic. */
#ifndef PL_ORBIT_TWO_BODY_H
#define PL_ORBIT_TWO_BODY_H

#include "math/rotation.h"
#include "orbit/propagator.h"

extern const pl_propagator_kind pl_kepler_kind;

/* Creates a propagator for the motion on `orbit`; `frame` rotates its axes to ICRF. Fails with
 * PL_E_MEMORY. */
pl_status pl_kepler_create(const pl_orbit *orbit, pl_quat frame, pl_propagator **out);

#endif
