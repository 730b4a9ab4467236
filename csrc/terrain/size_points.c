#include "terrain/size_points.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

pl_status pl_size_points_check(const pl_size_points *points, const char *noun, double min_m,
                               double max_m) {
  if (points->count < 2 || points->diameters_m == NULL || points->densities == NULL)
    return pl_fail(PL_E_RANGE, "a table of %s needs 2 entries or more, not %zu", noun,
                   points->count);
  for (size_t k = 0; k < points->count; k++) {
    const double d = points->diameters_m[k], n = points->densities[k];
    if (!(d > 0.0 && isfinite(d) && n >= 0.0 && isfinite(n)) ||
        (k > 0 && !(d > points->diameters_m[k - 1] && n <= points->densities[k - 1])))
      return pl_fail(PL_E_RANGE,
                     "entry %zu of the table of %s: %g per m^2 of %g m or more; diameters must "
                     "rise from above 0, densities must not rise and be 0 or more",
                     k, noun, n, d);
  }
  const double first = points->diameters_m[0], last = points->diameters_m[points->count - 1];
  if (min_m < first || max_m > last)
    return pl_fail(PL_E_RANGE, "%s of %g to %g m; the table of %s has %g to %g m", noun, min_m,
                   max_m, noun, first, last);
  return PL_OK;
}

pl_status pl_size_power_check(const char *noun, double coefficient, double exponent) {
  if (coefficient >= 0.0 && isfinite(coefficient) && exponent <= 0.0 && isfinite(exponent))
    return PL_OK;
  return pl_fail(PL_E_RANGE,
                 "power law of %s %g D^%g; the coefficient must be 0 or more, the exponent 0 or "
                 "less",
                 noun, coefficient, exponent);
}

double pl_size_points_density(const pl_size_points *points, double diameter_m) {
  size_t k = 0;
  while (k + 2 < points->count && points->diameters_m[k + 1] <= diameter_m)
    k++;
  const double a = points->densities[k], b = points->densities[k + 1];
  const double f = log(diameter_m / points->diameters_m[k]) /
                   log(points->diameters_m[k + 1] / points->diameters_m[k]);
  return a > 0.0 && b > 0.0 ? a * pow(b / a, f) : fmax(a + f * (b - a), 0.0);
}

pl_status pl_size_points_copy(pl_size_points *points, double **block) {
  const size_t bytes = points->count * sizeof(double);
  void *copy;
  PL_TRY(pl_alloc_or_fail(2 * points->count, sizeof(double), "a table of sizes", &copy));
  double *numbers = copy;
  memcpy(numbers, points->diameters_m, bytes);
  memcpy(numbers + points->count, points->densities, bytes);
  points->diameters_m = numbers;
  points->densities = numbers + points->count;
  *block = numbers;
  return PL_OK;
}
