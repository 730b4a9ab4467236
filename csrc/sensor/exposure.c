/* Metering: the white level from the luminances of an image. */
#include "sensor/exposure.h"

#include <stdlib.h>

static int ascending(const void *a, const void *b) {
  const float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

double pl_exposure_meter(const pl_exposure *exposure, float *luminances, size_t count,
                         double fallback) {
  const double lit = 1e-3;
  size_t first = 0;
  if (count == 0)
    return fallback;
  for (size_t i = 0; i < count; i++)
    if (!(luminances[i] > 0.0f)) /* NaN cannot be sorted */
      luminances[i] = 0.0f;
  qsort(luminances, count, sizeof *luminances, ascending);
  const double threshold = lit * fmin(luminances[count - 1], fallback);
  while (first < count && !(luminances[first] > threshold))
    first++;
  if (first == count)
    return fallback;
  const double place = exposure->percentile / 100.0 * (double)(count - 1 - first);
  const double metered = luminances[first + (size_t)(place + 0.5)];
  const double least = fmin(exposure->least_white, fallback);
  return metered > 0.0 ? fmax(metered / exposure->key, least) : fallback;
}
