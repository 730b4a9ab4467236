/* Solves the plan: the tolerance is spent, row by row, where it saves most time. */
#include "plan/plan.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>

int pl_effect_ceiling_one(const pl_view *view) {
  (void)view;
  return 1;
}

/* Returns the smallest value whose residual is within `left_dn`, by bisection: bounds fall with the
 * value. The ceiling if none is. */
static int smallest_value(const pl_plan_row *row, const pl_view *view, double left_dn) {
  int low = 0, high = row->ceiling;
  while (low < high) {
    const int middle = low + (high - low) / 2;
    const double bound = middle > 0 ? row->effect->bound_dn(view, middle) : row->bound_dn;
    if (bound <= left_dn)
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

/* What is known of a row before any is decided. */
static const char *look_at_row(const pl_view *view, pl_plan_row *row) {
  const char *absent = row->effect->absent(view);
  if (absent != NULL)
    return absent;
  row->ceiling = row->effect->ceiling(view);
  row->bound_dn = row->effect->bound_dn(view, 0);
  return NULL;
}

static void set_value(const pl_view *view, int value, pl_plan_row *row) {
  row->value = value;
  row->residual_dn = value > 0 ? row->effect->bound_dn(view, value) : row->bound_dn;
  row->cost_ms = value > 0 ? row->effect->cost_ms(view, value) : 0.0;
}

/* The row of an effect that is absent or forced. */
static void fill_given_row(const pl_view *view, const char *absent, bool on, bool off,
                           pl_plan_row *row) {
  snprintf(row->reason, sizeof row->reason, "%s",
           off  ? "left out by force_off"
           : on ? "kept by force_on"
                : absent);
  if (absent == NULL)
    set_value(view, off ? 0 : row->ceiling, row);
  else if (on && !off)
    row->value = row->ceiling = row->effect->ceiling(view);
}

static void decide_row(const pl_view *view, double tolerance_dn, double left_dn, pl_plan_row *row) {
  set_value(view, smallest_value(row, view, left_dn), row);
  const bool within = row->residual_dn <= left_dn;
  row->spent_dn = within ? row->residual_dn : 0.0;
  char rest[48] = "";
  if (left_dn < tolerance_dn)
    snprintf(rest, sizeof rest, ", of which %.2g is left", left_dn);
  if (row->value == 0) {
    snprintf(row->reason, sizeof row->reason, "changes at most %.2g DN, tolerance is %.2g%s",
             row->bound_dn, tolerance_dn, rest);
    return;
  }
  const int at =
      snprintf(row->reason, sizeof row->reason, "can change %.3g DN, tolerance is %.2g%s",
               row->bound_dn, tolerance_dn, row->bound_dn > tolerance_dn ? "" : rest);
  if (row->value > 1 && !within)
    snprintf(row->reason + at, sizeof row->reason - (size_t)at,
             "; %d, as many as there may be, leave %.3g", row->value, row->residual_dn);
}

/* Milliseconds saved by a digital number of the tolerance, if the row is left out. */
static double worth(const pl_view *view, const pl_plan_row *row) {
  if (row->bound_dn > 0.0)
    return row->effect->cost_ms(view, row->ceiling) / row->bound_dn;
  return row->bound_dn == 0.0 ? INFINITY : 0.0; /* what is not known is kept, and comes last */
}

pl_status pl_plan_solve(const pl_effect *const *effects, size_t count, const pl_view *view,
                        const pl_plan_wish *wish, pl_plan *out) {
  *out = (pl_plan){.count = count};
  if (count > PL_PLAN_ROWS_MAX)
    return pl_fail(PL_E_ARGUMENT, "%zu effects: a plan holds at most %d", count, PL_PLAN_ROWS_MAX);
  size_t order[PL_PLAN_ROWS_MAX], open = 0;
  double worths[PL_PLAN_ROWS_MAX];
  for (size_t i = 0; i < count; i++) {
    const bool on = pl_effect_set_has(&wish->force_on, i);
    const bool off = pl_effect_set_has(&wish->force_off, i);
    if (on && off)
      return pl_fail(PL_E_ARGUMENT, "effect '%s' is in both force_on and force_off",
                     effects[i]->name);
    pl_plan_row *row = &out->rows[i];
    row->effect = effects[i];
    const char *absent = look_at_row(view, row);
    if (on || off || absent != NULL) {
      fill_given_row(view, absent, on, off, row);
      continue;
    }
    /* Kept in order as they come; equals stay in the order of the table. */
    worths[i] = worth(view, row);
    size_t at = open++;
    for (; at > 0 && worths[order[at - 1]] < worths[i]; at--)
      order[at] = order[at - 1];
    order[at] = i;
  }
  double left_dn = wish->tolerance_dn;
  for (size_t k = 0; k < open; k++) {
    decide_row(view, wish->tolerance_dn, left_dn, &out->rows[order[k]]);
    left_dn = fmax(left_dn - out->rows[order[k]].spent_dn, 0.0);
  }
  return PL_OK;
}

void pl_plan_solve_again(const pl_effect *effect, const pl_view *view, const pl_plan_wish *wish,
                         pl_plan *plan) {
  double left_dn = wish->tolerance_dn;
  for (size_t i = 0; i < plan->count; i++)
    left_dn -= plan->rows[i].effect != effect ? plan->rows[i].spent_dn : 0.0;
  for (size_t i = 0; i < plan->count; i++) {
    if (plan->rows[i].effect != effect)
      continue;
    pl_plan_row *row = &plan->rows[i];
    *row = (pl_plan_row){.effect = effect};
    const char *absent = look_at_row(view, row);
    const bool on = pl_effect_set_has(&wish->force_on, i);
    const bool off = pl_effect_set_has(&wish->force_off, i);
    if (on || off || absent != NULL)
      fill_given_row(view, absent, on, off, row);
    else
      decide_row(view, wish->tolerance_dn, fmax(left_dn, 0.0), row);
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
