/* The table of propagator kinds, and dispatch to them. */
#include "orbit/propagator.h"

#include "orbit/circular.h"
#include "orbit/j2.h"
#include "orbit/table.h"
#include "orbit/numerical.h"
#include "orbit/two_body.h"

static const pl_propagator_kind *const kinds[] = {
    &pl_kepler_kind, &pl_circular_kind, &pl_j2_kind, &pl_table_kind, &pl_numerical_kind,
};

const pl_propagator_kind *const *pl_propagator_kinds(size_t *count) {
  *count = sizeof kinds / sizeof kinds[0];
  return kinds;
}

pl_status pl_propagator_states(const pl_propagator *propagator, size_t count, const double *t_s,
                               pl_state *out) {
  for (size_t i = 0; i < count; i++)
    if (!isfinite(t_s[i]))
      return pl_fail(PL_E_RANGE, "time %zu is %g, but must be finite", i, t_s[i]);
  return propagator->kind->states(propagator, count, t_s, out);
}

void pl_propagator_destroy(pl_propagator *propagator) {
  if (propagator)
    propagator->kind->destroy(propagator);
}
