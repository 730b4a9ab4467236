/* Error of the integral along a ray as a function of the number of steps. It is measured for each
 * atmosphere when it is built, on rays of many kinds. */
#include <math.h>

#include "air/light_bounds.h"
#include "air/table.h"

static const int rules[PL_AIR_RULES] = {1, 2, 3, 4, 5, 6, 8, 10, 12, 14, 16, 24, 32};

/* Safety factors, since rays that were not tried may have larger errors than those that were;
 * verified by tests/c/test_air_steps.c. The second is for air whose optical depth along the horizon
 * exceeds OPAQUE: only a thin part of it is visible, and few rays are alike. */
static const double MARGIN[2] = {3.0, 15.0}, OPAQUE = 100.0;

/* `lows`: lowest points of rays from outside, below 0 if they end on the ground. `eyes`: heights of
 * viewpoints in the air. Both are fractions of the top's height. Then zenith cosines of rays from
 * these viewpoints, and cosines of the sun's zenith angle at a ray's lowest point or start, each
 * with the sun ahead, aside and behind. */
static const double lows[] = {-0.5, -0.1, -0.03, -0.003, 0.0, 0.01, 0.04, 0.1, 0.2, 0.35};
static const double eyes[] = {0.0, 0.03, 0.2};
static const double cosines[] = {-0.3, -0.06, -0.02, 0.0, 0.02, 0.1, 0.4, 1.0};
static const double suns[] = {0.9, 0.4, 0.08, -0.06, -0.15};
enum { AZIMUTHS = 3 };

double pl_air_off_by(pl_vec3f is, pl_vec3f exact) {
  const float pairs[3][2] = {{is.x, exact.x}, {is.y, exact.y}, {is.z, exact.z}};
  double worst = 0.0;
  for (int k = 0; k < 3; k++) {
    const double found = (double)pairs[k][0], light = (double)pairs[k][1];
    const double dark = fmax(fmin(found, light), PL_AIR_DARK);
    worst = fmax(worst, fabs(found - light) / pow(dark, PL_AIR_POWER));
  }
  return worst;
}

/* Tries a ray from radius r with zenith cosine mu, with the suns over its lowest point or its
 * start. */
static void try_ray(const pl_air *air, const pl_air_rule rule[PL_AIR_RULES + 1], double r,
                    double mu, double off[PL_AIR_RULES]) {
  const double across = sqrt((1.0 - mu) * (1.0 + mu)), along = fmax(0.0, -r * mu);
  pl_air_ray ray = {
      .origin = {0.0, 0.0, r}, .direction = {across, 0.0, mu}, .stretch = 1.0, .end = INFINITY};
  const pl_vec3 up = pl_vec3_unit(pl_vec3_madd(ray.origin, along, ray.direction));
  const pl_vec3 ahead = {up.z, 0.0, -up.x}, aside = {0.0, 1.0, 0.0};
  for (size_t i = 0; i < AZIMUTHS * sizeof suns / sizeof *suns; i++) {
    const double height = suns[i / AZIMUTHS], flat = sqrt(1.0 - height * height);
    const double turn = 0.1 + PL_PI / 2.0 * (double)(i % AZIMUTHS);
    pl_air_sun sun = {.stretch = 1.0, .radius_rad = 0.00465};
    sun.direction = pl_vec3_madd(pl_vec3_madd(pl_vec3_scale(up, height), flat * cos(turn), ahead),
                                 flat * sin(turn), aside);
    ray.sun_cosine = (float)pl_vec3_dot(ray.direction, sun.direction);
    const pl_vec3f exact = pl_air_scatter(air, &ray, &sun, &rule[PL_AIR_RULES], false).scattered;
    for (int k = 0; k < PL_AIR_RULES; k++) {
      off[k] = fmax(
          off[k], pl_air_off_by(pl_air_scatter(air, &ray, &sun, &rule[k], false).scattered, exact));
    }
  }
}

void pl_air_measure_steps(const pl_air *air, double depth, double off[PL_AIR_RULES]) {
  const double top = air->settings.top_m / air->radius_m, r = 1.0 + 1.5 * top;
  pl_air_rule rule[PL_AIR_RULES + 1];
  for (int k = 0; k < PL_AIR_RULES; k++)
    rule[k] = pl_air_rule_make(rules[k]);
  rule[PL_AIR_RULES] = pl_air_rule_make(PL_AIR_STEPS_MAX);
  for (size_t i = 0; i < sizeof lows / sizeof *lows; i++) {
    const double low = (1.0 + lows[i] * top) / r;
    try_ray(air, rule, r, -sqrt((1.0 - low) * (1.0 + low)), off);
  }
  for (size_t i = 0; i < sizeof eyes / sizeof *eyes; i++)
    for (size_t k = 0; k < sizeof cosines / sizeof *cosines; k++)
      try_ray(air, rule, 1.0 + eyes[i] * top, cosines[k], off);
  for (int k = PL_AIR_RULES - 1; k >= 0; k--)
    off[k] = fmax(MARGIN[depth > OPAQUE] * off[k], k + 1 < PL_AIR_RULES ? off[k + 1] : 0.0);
}

double pl_air_step_error(const pl_air_light_bounds *bounds, int steps) {
  int i = 0;
  while (i + 1 < PL_AIR_RULES && rules[i + 1] <= steps)
    i++;
  return bounds->steps_off[i];
}
