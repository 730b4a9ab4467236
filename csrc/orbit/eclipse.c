/* Overlap of two discs without the cancellation of the textbook formula with arccosines.
 *
 * The overlap consists of two circular segments of half angles ta and tb on a common chord of half
 * length y. The area of a segment is r^2 (t - sin t cos t). The half angles are computed by atan2
 * from y and the signed distances of the chord. Small t - sin t cos t are computed by a series,
 * since the disc of a planet is hundreds of times larger than the Sun's: tb is then tiny and b^2
 * huge. */
#include "orbit/eclipse.h"

#include <stdbool.h>

#define SUN_RADIUS_M 695700e3 /* IAU 2015 nominal */
#define SERIES_TERMS 12

/* x - sin x. */
static double minus_sine(double x) {
  if (fabs(x) >= 1.0)
    return x - sin(x);
  double sum = 1.0; /* x^3/6 (1 - x^2/20 (1 - x^2/42 (...))) */
  for (int k = SERIES_TERMS; k >= 1; k--)
    sum = 1.0 - x * x / ((2.0 * k + 2.0) * (2.0 * k + 3.0)) * sum;
  return x * x * x / 6.0 * sum;
}

/* t - sin t cos t. */
static double segment(double t) { return 0.5 * minus_sine(2.0 * t); }

double pl_eclipse_fraction(double a, double b, double c) {
  if (c >= a + b)
    return 1.0;
  if (c <= b - a)
    return 0.0;
  if (c <= a - b) /* annular */
    return 1.0 - (b / a) * (b / a);
  const double y = sqrt((a + b + c) * ((c - b) + a) * (a - (c - b)) * ((b - a) + c)) / (2.0 * c);
  const double xa = ((c - b) * (c + b) + a * a) / (2.0 * c);
  const double hidden = a * a * segment(atan2(y, xa)) + b * b * segment(atan2(y, c - xa));
  return fmin(fmax(1.0 - hidden / (PL_PI * a * a), 0.0), 1.0);
}

/* Angular radii of the Sun (a) and the sphere (b) as seen from a point outside it, and their
 * separation (c). */
typedef struct discs {
  double a, b, c;
} discs;

/* Returns false if an eclipse is impossible because the Sun is closer than the sphere's centre. */
static bool discs_from(pl_vec3 r_m, pl_vec3 sun_m, double radius_m, discs *out) {
  const pl_vec3 to_sun = pl_vec3_sub(sun_m, r_m), down = pl_vec3_scale(r_m, -1.0);
  const double r = pl_vec3_norm(r_m), far = pl_vec3_norm(to_sun);
  out->a = asin(fmin(1.0, SUN_RADIUS_M / far));
  out->b = asin(fmin(1.0, radius_m / r));
  out->c = atan2(pl_vec3_norm(pl_vec3_cross(to_sun, down)), pl_vec3_dot(to_sun, down));
  return far > r;
}

double pl_eclipse_sunlight(pl_vec3 r_m, pl_vec3 sun_m, double radius_m) {
  discs d;
  if (!(pl_vec3_norm(r_m) > radius_m))
    return 0.0;
  return discs_from(r_m, sun_m, radius_m, &d) ? pl_eclipse_fraction(d.a, d.b, d.c) : 1.0;
}

int pl_eclipse_regime(pl_vec3 r_m, pl_vec3 sun_m, double radius_m) {
  discs d;
  if (!(pl_vec3_norm(r_m) > radius_m))
    return 2;
  if (!discs_from(r_m, sun_m, radius_m, &d) || d.c >= d.a + d.b)
    return 0;
  if (d.c <= d.b - d.a)
    return 2;
  return d.c <= d.a - d.b ? 3 : 1;
}
