/* The table of all effect rows. */
#ifndef PL_FRAME_EFFECTS_H
#define PL_FRAME_EFFECTS_H

#include "plan/effects.h"
#include "plan/plan.h"

extern const pl_effect *const pl_effects[];
extern const size_t pl_effect_count;

/* Returns the index of the effect with this name, or -1. */
int pl_effect_find(const char *name);

/* The values of a plan. */
pl_effect_values pl_plan_values(const pl_plan *plan);

#endif
