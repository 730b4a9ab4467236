/* The table of all effect rows. */
#include "frame/effects.h"

#include <string.h>

#define PL_ADDRESS(name) &pl_effect_##name,
const pl_effect *const pl_effects[] = {PL_EFFECTS(PL_ADDRESS)};
const size_t pl_effect_count = sizeof pl_effects / sizeof pl_effects[0];

pl_effect_values pl_plan_values(const pl_plan *plan) {
#define PL_SET(name) .name = pl_plan_value(plan, &pl_effect_##name),
  return (pl_effect_values){PL_EFFECTS(PL_SET)};
#undef PL_SET
}

int pl_effect_find(const char *name) {
  for (size_t i = 0; i < pl_effect_count; i++)
    if (strcmp(pl_effects[i]->name, name) == 0)
      return (int)i;
  return -1;
}
