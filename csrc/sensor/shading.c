/* Vignetting by a power of the cosine, a table and a flat field. */
#include "sensor/shading.h"

#include <math.h>
#include <stddef.h>

pl_status pl_shading_set_flat(pl_shading *shading, const float *flat, int width, int height) {
  double low = INFINITY, high = 0.0;
  for (size_t i = 0; i < (size_t)width * (size_t)height; i++) {
    if (!(flat[i] >= 0.0f && flat[i] <= 100.0f))
      return pl_fail(PL_E_RANGE, "sensor: flat field: factors must be in 0..100, not %g",
                     (double)flat[i]);
    low = fmin(low, flat[i]);
    high = fmax(high, flat[i]);
  }
  shading->flat = flat;
  shading->flat_width = width;
  shading->flat_height = height;
  shading->flat_low = low;
  shading->flat_high = high;
  return PL_OK;
}

pl_status pl_shading_check(const pl_shading *shading) {
  if (!(shading->power >= 0.0 && shading->power <= 100.0))
    return pl_fail(PL_E_RANGE, "sensor: vignetting must be in 0..100, not %g", shading->power);
  if (shading->count < 0 || shading->count > PL_SHADING_POINTS)
    return pl_fail(PL_E_RANGE, "sensor: a vignetting profile has 1..%d points, not %d",
                   PL_SHADING_POINTS, shading->count);
  for (int i = 0; i < shading->count; i++) {
    const double least = i > 0 ? shading->angle_rad[i - 1] : 0.0, angle = shading->angle_rad[i];
    if (!(angle < 4.0 && (i > 0 ? angle > least : angle >= least)))
      return pl_fail(PL_E_RANGE, "sensor: the angles of a vignetting profile must rise from 0");
    if (!(shading->factor[i] >= 0.0 && shading->factor[i] <= 1.0))
      return pl_fail(PL_E_RANGE, "sensor: the factors of a vignetting profile must be in 0..1");
  }
  return PL_OK;
}

static double profile(const pl_shading *s, double tangent) {
  const double angle = atan(tangent);
  int i = 0;
  while (i < s->count && s->angle_rad[i] < angle)
    i++;
  if (i == 0 || i == s->count)
    return s->factor[i == 0 ? 0 : i - 1];
  const double part = (angle - s->angle_rad[i - 1]) / (s->angle_rad[i] - s->angle_rad[i - 1]);
  return s->factor[i - 1] + part * (s->factor[i] - s->factor[i - 1]);
}

/* The texel before a position along an axis. *part: fraction of the distance to the next one. */
static int texel(double place, int count, double *part) {
  const double at = fmin(fmax(place * count - 0.5, 0.0), count - 1.0);
  const int first = at < count - 1.0 ? (int)at : count - 1;
  *part = at - first;
  return first;
}

static double flat(const pl_shading *s, const double place[2]) {
  double u, v;
  const int x = texel(place[0], s->flat_width, &u), y = texel(place[1], s->flat_height, &v);
  const int right = x + 1 < s->flat_width, below = y + 1 < s->flat_height;
  const float *upper = s->flat + (size_t)y * (size_t)s->flat_width + x;
  const float *lower = upper + (below ? s->flat_width : 0);
  return (1.0 - v) * ((1.0 - u) * upper[0] + u * upper[right]) +
         v * ((1.0 - u) * lower[0] + u * lower[right]);
}

double pl_shading_at(const pl_shading *shading, const double tangent[2], const double place[2]) {
  const double square = tangent[0] * tangent[0] + tangent[1] * tangent[1];
  double factor = pow(1.0 + square, -0.5 * shading->power); /* cos^2 = 1 / (1 + tan^2) */
  if (shading->count > 0)
    factor *= profile(shading, sqrt(square));
  return shading->flat != NULL ? factor * flat(shading, place) : factor;
}

void pl_shading_range(const pl_shading *shading, double tangent, double *low, double *high) {
  double least = 1.0, most = 0.0;
  for (int i = 0; i < shading->count; i++) {
    least = fmin(least, shading->factor[i]);
    most = fmax(most, shading->factor[i]);
  }
  *low = pow(1.0 + tangent * tangent, -0.5 * shading->power);
  *high = 1.0;
  if (shading->count > 0) {
    *low *= least;
    *high *= most;
  }
  if (shading->flat != NULL) {
    *low *= shading->flat_low;
    *high *= shading->flat_high;
  }
}
