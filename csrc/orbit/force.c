/* The list of forces, and the validation that they share. */
#include "orbit/force.h"

#include <string.h>

static const pl_force_kind *const kinds[] = {
    &pl_force_point_mass, &pl_force_zonal, &pl_force_harmonics,
    &pl_force_third_body, &pl_force_drag,  &pl_force_radiation_pressure,
};
#define KIND_COUNT (sizeof kinds / sizeof kinds[0])

const pl_force_kind *const *pl_force_kinds(size_t *count) {
  *count = KIND_COUNT;
  return kinds;
}

pl_status pl_force_require(const char *name, const pl_force_kind **out) {
  char names[256] = "";
  for (size_t i = 0; i < KIND_COUNT; i++) {
    if (strcmp(kinds[i]->name, name) == 0) {
      *out = kinds[i];
      return PL_OK;
    }
    pl_names_append(names, sizeof names, kinds[i]->name);
  }
  return pl_fail(PL_E_ARGUMENT, "no force named '%s'; allowed: %s", name, names);
}

static pl_status check_numbers(const pl_force_parameter *p, const pl_force_value *value) {
  if (p->count > 0 && value->count != p->count)
    return pl_fail(PL_E_ARGUMENT, "%s must have %zu numbers, not %zu", p->key, p->count,
                   value->count);
  for (size_t i = 0; i < value->count; i++)
    if (!isfinite(value->numbers[i]))
      return pl_fail(PL_E_RANGE, "%s[%zu] is not finite", p->key, i);
  return PL_OK;
}

pl_status pl_force_create(const pl_force_kind *kind, const pl_force_setting *setting,
                          const pl_force_value *values, pl_force **out) {
  for (size_t i = 0; i < kind->parameter_count; i++) {
    const pl_force_parameter *p = &kind->parameters[i];
    const pl_force_value *value = &values[i];
    if (!value->count && !value->body && !value->motion && !p->optional)
      return pl_fail(PL_E_ARGUMENT, "%s is missing: %s", p->key, p->doc);
    if (value->count)
      PL_TRY(check_numbers(p, value));
  }
  return kind->create(setting, values, out);
}
