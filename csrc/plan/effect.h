/* Interface of an effect: one row of the table of effects. */
#ifndef PL_PLAN_EFFECT_H
#define PL_PLAN_EFFECT_H

#include "plan/view.h"

/* An effect is set to an integer: 0 is off, 1 is on, and larger values are a count (samples,
 * bounces) where the effect has one. All functions are pure. */
typedef struct pl_effect {
  const char *name;
  const char *doc; /* one sentence: what the effect is and what its value counts */
  /* Returns why the effect cannot matter in this view at any tolerance, or NULL if it can. */
  const char *(*absent)(const pl_view *view);
  /* Returns the largest useful value; at least 1. */
  int (*ceiling)(const pl_view *view);
  /* Returns an upper bound of the difference of a pixel, in digital numbers, between `value` and
   * the limit of infinitely large values. */
  double (*bound_dn)(const pl_view *view, int value);
  /* Returns the approximate cost at `value`, milliseconds on one thread. Like the bound, it is not
   * called when the effect is absent. */
  double (*cost_ms)(const pl_view *view, int value);
} pl_effect;

int pl_effect_ceiling_one(const pl_view *view); /* for effects that are only on or off */

#endif
