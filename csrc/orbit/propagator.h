/* Propagators: motion of a body relative to its parent as a function of time. */
#ifndef PL_ORBIT_PROPAGATOR_H
#define PL_ORBIT_PROPAGATOR_H

#include <stddef.h>

#include "base/status.h"
#include "orbit/kepler.h"

/* Made by the create function of its kind and destroyed with pl_propagator_destroy. It is immutable
 * for its users and can be used by several threads at once: results depend on its parameters and
 * the time only, not on earlier calls. */
typedef struct pl_propagator pl_propagator;

typedef struct pl_propagator_kind {
  const char *name; /* "kepler" */
  const char *doc;  /* what it models, and its stated error */
  /* States at `count` finite times. A kind keeps no state that affects later results, and allocates
   * memory only when it first covers a range of times. */
  pl_status (*states)(const pl_propagator *self, size_t count, const double *t_s, pl_state *out);
  void (*destroy)(pl_propagator *self);
} pl_propagator_kind;

/* First member of each kind's struct. */
struct pl_propagator {
  const pl_propagator_kind *kind;
};

/* All kinds, in a fixed order; static. */
const pl_propagator_kind *const *pl_propagator_kinds(size_t *count);

/* States relative to the centre of the parent, ICRF axes, at times `t_s` after the propagator's
 * epoch, any sign. Fails with PL_E_RANGE for a time that is not finite or that the kind does not
 * support. */
pl_status pl_propagator_states(const pl_propagator *propagator, size_t count, const double *t_s,
                               pl_state *out);

/* `propagator` may be NULL. */
void pl_propagator_destroy(pl_propagator *propagator);

#endif
