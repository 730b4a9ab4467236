/* The plan of a frame: which effects are kept, at what value, and why. */
#ifndef PL_PLAN_PLAN_H
#define PL_PLAN_PLAN_H

#include <stdint.h>

#include "base/status.h"
#include "plan/effect.h"

enum { PL_PLAN_ROWS_MAX = 64, PL_PLAN_REASON = 120 };

typedef struct pl_plan_row {
  const pl_effect *effect; /* borrowed from the table */
  int value;               /* 0: off */
  double bound_dn;         /* of leaving it out */
  double residual_dn;      /* of keeping it at `value` instead of at the limit */
  double cost_ms;          /* at `value`; 0 when off */
  char reason[PL_PLAN_REASON];
} pl_plan_row;

typedef struct pl_plan {
  size_t count;
  pl_plan_row rows[PL_PLAN_ROWS_MAX];
} pl_plan;

/* What the user asks of the plan. Masks are over the indices of the table. */
typedef struct pl_plan_wish {
  double tolerance_dn;
  uint64_t force_on, force_off;
} pl_plan_wish;

/* Keeps each effect whose bound exceeds the tolerance, at the smallest value whose residual does
 * not, or at its ceiling. Forcing on sets the ceiling. PL_E_ARGUMENT if a row is forced both ways.
 */
pl_status pl_plan_solve(const pl_effect *const *effects, size_t count, const pl_view *view,
                        const pl_plan_wish *wish, pl_plan *out);

/* Value of an effect, by its row; 0 when off, or not in the plan. */
int pl_plan_value(const pl_plan *plan, const pl_effect *effect);

#endif
