/* The contract of an effect: one row of the table of what can be simulated. */
#ifndef PL_PLAN_EFFECT_H
#define PL_PLAN_EFFECT_H

#include "plan/view.h"

/* An effect is set to a whole value: 0 is off, 1 on, more where it has a count (samples, bounces).
 * All functions are pure. */
typedef struct pl_effect {
  const char *name;
  const char *doc; /* one sentence: what it is and what its value counts */
  /* Why the effect cannot matter in this view whatever the tolerance, or NULL if it can. */
  const char *(*absent)(const pl_view *view);
  /* Largest value worth setting; at least 1. */
  int (*ceiling)(const pl_view *view);
  /* Upper bound of what a pixel changes, in digital numbers, between `value` and the limit of all.
   */
  double (*bound_dn)(const pl_view *view, int value);
  /* Rough cost at `value`, milliseconds on one thread. Like the bound, not asked when absent. */
  double (*cost_ms)(const pl_view *view, int value);
} pl_effect;

int pl_effect_ceiling_one(const pl_view *view); /* for effects that are only on or off */

#endif
