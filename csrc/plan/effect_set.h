/* A set of effects, by their indices in a table of effects. */
#ifndef PL_PLAN_EFFECT_SET_H
#define PL_PLAN_EFFECT_SET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Largest number of rows of a table; effects.h checks its own when it is compiled. */
enum { PL_PLAN_ROWS_MAX = 128, PL_EFFECT_WORD = 64 };
_Static_assert(PL_PLAN_ROWS_MAX % PL_EFFECT_WORD == 0, "sets are whole words");

typedef struct pl_effect_set {
  uint64_t words[PL_PLAN_ROWS_MAX / PL_EFFECT_WORD];
} pl_effect_set;

static inline bool pl_effect_set_has(const pl_effect_set *set, size_t index) {
  return (set->words[index / PL_EFFECT_WORD] >> index % PL_EFFECT_WORD & 1u) != 0;
}
static inline void pl_effect_set_add(pl_effect_set *set, size_t index) {
  set->words[index / PL_EFFECT_WORD] |= UINT64_C(1) << index % PL_EFFECT_WORD;
}

#endif
