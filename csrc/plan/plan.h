/* Plan of a frame: which effects are kept, at what value, and why. */
#ifndef PL_PLAN_PLAN_H
#define PL_PLAN_PLAN_H

#include <stdint.h>

#include "base/status.h"
#include "plan/effect.h"
#include "plan/effect_set.h"

enum { PL_PLAN_REASON = 120 };

typedef struct pl_plan_row {
  const pl_effect *effect; /* borrowed from the table */
  int value;               /* 0 when off */
  int ceiling;             /* the largest useful value; 0 when absent */
  double bound_dn;         /* error bound of leaving the effect out, digital numbers */
  double residual_dn;      /* error bound of `value` compared with the limit, digital numbers */
  double spent_dn;         /* what `value` takes of the tolerance, digital numbers */
  double cost_ms;          /* at `value`; 0 when off */
  char reason[PL_PLAN_REASON];
} pl_plan_row;

typedef struct pl_plan {
  size_t count;
  pl_plan_row rows[PL_PLAN_ROWS_MAX];
} pl_plan;

/* The user's settings for the plan. Sets are of indices into the table of effects. */
typedef struct pl_plan_wish {
  double tolerance_dn;
  pl_effect_set force_on, force_off;
} pl_plan_wish;

/* Spends the tolerance on what saves most time: bounds add linearly, since errors of a pixel may
 * all have one sign. Rows take turns, the greatest cost per bound first. Each takes the smallest
 * value whose residual fits into the rest of the tolerance. An effect that even its ceiling leaves
 * above that has its ceiling, and takes nothing: there is no finer value. Forcing an effect on sets
 * its ceiling. Returns PL_E_ARGUMENT if an effect is forced both on and off. */
pl_status pl_plan_solve(const pl_effect *const *effects, size_t count, const pl_view *view,
                        const pl_plan_wish *wish, pl_plan *out);

/* Decides the row of one effect again, with a view that knows more, within the tolerance that the
 * other rows leave. */
void pl_plan_solve_again(const pl_effect *effect, const pl_view *view, const pl_plan_wish *wish,
                         pl_plan *plan);

/* Returns the row of an effect; NULL if it is not in the plan. */
const pl_plan_row *pl_plan_row_of(const pl_plan *plan, const pl_effect *effect);
/* Returns the value of an effect in the plan; 0 when it is off or not in the plan. */
int pl_plan_value(const pl_plan *plan, const pl_effect *effect);

#endif
