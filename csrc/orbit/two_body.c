/* Wraps orbit/kepler.h as a propagator. */
#include "orbit/two_body.h"

#include "base/memory.h"

typedef struct two_body {
  pl_propagator base;
  pl_orbit orbit; /* ICRF axes */
} two_body;

static pl_status two_body_states(const pl_propagator *self, size_t count, const double *t_s,
                                 pl_state *out) {
  return pl_orbit_states(&((const two_body *)self)->orbit, count, t_s, out);
}

static void two_body_destroy(pl_propagator *self) { pl_free(self); }

const pl_propagator_kind pl_kepler_kind = {
    .name = "kepler",
    .doc = "Two-body motion: ellipse, parabola, hyperbola and all between, in closed form. Against "
           "the equations: 1e-12 + 4 eps n |t| relative. Against a real low orbit: about 50 to 150 "
           "km a revolution, since the centre's flattening is left out.",
    .states = two_body_states,
    .destroy = two_body_destroy,
};

pl_status pl_kepler_create(const pl_orbit *orbit, pl_quat frame, pl_propagator **out) {
  two_body *self = NULL;
  PL_TRY(pl_alloc_or_fail(1, sizeof *self, "kepler propagator", (void **)&self));
  self->base.kind = &pl_kepler_kind;
  self->orbit = *orbit;
  self->orbit.p_axis = pl_quat_rotate(frame, orbit->p_axis);
  self->orbit.q_axis = pl_quat_rotate(frame, orbit->q_axis);
  *out = &self->base;
  return PL_OK;
}
