/* The table of reflectance models. */
#include "shade/reflectance.h"

#include <string.h>

#define PL_ADDRESS(row) &pl_reflectance_##row,
const pl_reflectance *const pl_reflectances[] = {PL_REFLECTANCES(PL_ADDRESS)};
const size_t pl_reflectance_count = sizeof pl_reflectances / sizeof pl_reflectances[0];

const pl_reflectance *pl_reflectance_find(const char *name) {
  for (size_t i = 0; i < pl_reflectance_count; i++)
    if (strcmp(pl_reflectances[i]->name, name) == 0)
      return pl_reflectances[i];
  return NULL;
}
