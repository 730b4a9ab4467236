/* Solves the plan: each row is decided independently, by its bound. */
#include "plan/plan.h"

#include <stdbool.h>
#include <stdio.h>

int pl_effect_ceiling_one(const pl_view *view) {
  (void)view;
  return 1;
}

/* Returns the smallest value whose residual is within the tolerance, by bisection: bounds fall with
 * the value. */
static int smallest_value(const pl_effect *effect, const pl_view *view, double tolerance_dn) {
  int low = 1, high = effect->ceiling(view);
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (effect->bound_dn(view, middle) <= tolerance_dn)
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

static void solve_row(const pl_view *view, const pl_plan_wish *wish, bool on, bool off,
                      pl_plan_row *row) {
  const pl_effect *effect = row->effect;
  const char *absent = effect->absent(view);
  row->bound_dn = absent != NULL ? 0.0 : effect->bound_dn(view, 0);
  if (off) {
    snprintf(row->reason, sizeof row->reason, "left out by force_off");
  } else if (on) {
    row->value = effect->ceiling(view);
    snprintf(row->reason, sizeof row->reason, "kept by force_on");
  } else if (absent != NULL) {
    snprintf(row->reason, sizeof row->reason, "%s", absent);
  } else if (row->bound_dn <= wish->tolerance_dn) {
    snprintf(row->reason, sizeof row->reason, "changes at most %.2g DN, tolerance is %.2g",
             row->bound_dn, wish->tolerance_dn);
  } else {
    row->value = smallest_value(effect, view, wish->tolerance_dn);
    const double left = effect->bound_dn(view, row->value);
    const int at =
        snprintf(row->reason, sizeof row->reason, "can change %.3g DN, tolerance is %.2g",
                 row->bound_dn, wish->tolerance_dn);
    if (row->value > 1 && left > wish->tolerance_dn)
      snprintf(row->reason + at, sizeof row->reason - (size_t)at,
               "; %d, as many as there may be, leave %.3g", row->value, left);
  }
  row->residual_dn = absent != NULL ? 0.0 : effect->bound_dn(view, row->value);
  row->cost_ms = row->value > 0 && absent == NULL ? effect->cost_ms(view, row->value) : 0.0;
}

pl_status pl_plan_solve(const pl_effect *const *effects, size_t count, const pl_view *view,
                        const pl_plan_wish *wish, pl_plan *out) {
  *out = (pl_plan){.count = count};
  if (count > PL_PLAN_ROWS_MAX)
    return pl_fail(PL_E_ARGUMENT, "%zu effects: a plan holds at most %d", count, PL_PLAN_ROWS_MAX);
  for (size_t i = 0; i < count; i++) {
    const bool on = pl_effect_set_has(&wish->force_on, i);
    const bool off = pl_effect_set_has(&wish->force_off, i);
    if (on && off)
      return pl_fail(PL_E_ARGUMENT, "effect '%s' is in both force_on and force_off",
                     effects[i]->name);
    out->rows[i].effect = effects[i];
    solve_row(view, wish, on, off, &out->rows[i]);
  }
  return PL_OK;
}

void pl_plan_solve_again(const pl_effect *effect, const pl_view *view, const pl_plan_wish *wish,
                         pl_plan *plan) {
  for (size_t i = 0; i < plan->count; i++) {
    if (plan->rows[i].effect != effect)
      continue;
    plan->rows[i] = (pl_plan_row){.effect = effect};
    solve_row(view, wish, pl_effect_set_has(&wish->force_on, i),
              pl_effect_set_has(&wish->force_off, i), &plan->rows[i]);
  }
}

const pl_plan_row *pl_plan_row_of(const pl_plan *plan, const pl_effect *effect) {
  for (size_t i = 0; i < plan->count; i++)
    if (plan->rows[i].effect == effect)
      return &plan->rows[i];
  return NULL;
}

int pl_plan_value(const pl_plan *plan, const pl_effect *effect) {
  const pl_plan_row *row = pl_plan_row_of(plan, effect);
  return row != NULL ? row->value : 0;
}
