/* Propagators: paths of a body about its parent, as a function of time, behind one interface. */
#ifndef PL_ORBIT_PROPAGATOR_H
#define PL_ORBIT_PROPAGATOR_H

#include <stddef.h>

#include "base/status.h"
#include "orbit/kepler.h"

/* Made by the create function of its kind, destroyed with pl_propagator_destroy. To its users it is
 * immutable, and one propagator may be asked by several threads at once: what it answers depends
 * on its parameters and the time alone, not on what was asked before. */
typedef struct pl_propagator pl_propagator;

typedef struct pl_propagator_kind {
  const char *name; /* "kepler" */
  const char *doc;  /* what it models, and its stated error */
  /* States at `count` finite times. A kind keeps nothing that a later call could see differently;
   * it allocates nothing once the times it was asked for are behind it. */
  pl_status (*states)(const pl_propagator *self, size_t count, const double *t_s, pl_state *out);
  void (*destroy)(pl_propagator *self);
} pl_propagator_kind;

/* The struct of each kind begins with this one. */
struct pl_propagator {
  const pl_propagator_kind *kind;
};

/* All kinds, in a fixed order; static. */
const pl_propagator_kind *const *pl_propagator_kinds(size_t *count);

/* States relative to the centre of the parent, ICRF axes, at times `t_s` after the propagator's
 * epoch, any sign. PL_E_RANGE for a time that is not finite or that the kind has no answer for. */
pl_status pl_propagator_states(const pl_propagator *propagator, size_t count, const double *t_s,
                               pl_state *out);

/* NULL is fine. */
void pl_propagator_destroy(pl_propagator *propagator);

#endif
