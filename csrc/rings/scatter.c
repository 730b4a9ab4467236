/* Light that a uniform layer scatters once and transmits. */
#include "rings/table.h"

/* Sines whose relative difference is below this are treated as equal. */
static const double ALIKE = 1e-4;
/* The sun's disc is divided into strips of equal area: heights of the strip centres above the
 * disc's centre, in units of its radius. */
static const double strips[] = {0.09833347320030121, 0.29904317575451006, 0.514584233175152,
                                0.7733898610653267};
enum { STRIPS = sizeof strips / sizeof *strips };

/* Adds `part` times the scattered light to the bands, for a phase function of 1. `sun_sine` is the
 * sine of the sun's elevation above the ring plane, positive if the sun is on the observer's side.
 */
static void add_light(const pl_rings *rings, const pl_rings_piece *piece, double sun_sine,
                      double part, double sum[3]) {
  const double mu = piece->sine, mu0 = fmax(fabs(sun_sine), 1e-12);
  const double c = 1.0 / mu, c0 = 1.0 / mu0;
  if (sun_sine > 0.0) {
    const pl_rings_mean both = pl_rings_average(rings, piece->low_m, piece->high_m, c + c0);
    for (int k = 0; k < 3; k++)
      sum[k] += part * mu0 / (mu + mu0) * both.lit[k];
    return;
  }
  const bool alike = fabs(mu - mu0) < ALIKE * mu0;
  const double a = alike ? c * (1.0 + ALIKE) : c, b = alike ? fmax(1.0, c * (1.0 - ALIKE)) : c0;
  const pl_rings_mean along = pl_rings_average(rings, piece->low_m, piece->high_m, a);
  const pl_rings_mean sunward = pl_rings_average(rings, piece->low_m, piece->high_m, b);
  for (int k = 0; k < 3; k++)
    sum[k] += part * fmax(0.0, c / (a - b) * (along.lit[k] - sunward.lit[k]));
}

pl_rings_light pl_rings_scatter(const pl_rings *rings, const pl_rings_piece *piece,
                                pl_vec3 direction, const pl_rings_sun *sun) {
  const double phase = pl_rings_phase(rings, pl_vec3_dot(direction, sun->direction));
  const double sine = piece->side * sun->direction.z;
  double sum[3] = {0.0, 0.0, 0.0};
  if (fabs(sine) > 4.0 * sun->sin_radius) {
    add_light(rings, piece, sine, 1.0, sum);
  } else {
    for (int i = 0; i < STRIPS; i++)
      for (int half = -1; half <= 1; half += 2)
        add_light(rings, piece, sine + half * strips[i] * sun->sin_radius, 0.5 / STRIPS, sum);
  }
  const pl_rings_mean seen =
      pl_rings_average(rings, piece->low_m, piece->high_m, 1.0 / piece->sine);
  return (pl_rings_light){.transmittance = 1.0 - seen.opacity,
                          .scattered = {phase * sum[0], phase * sum[1], phase * sum[2]}};
}

pl_rings_light pl_rings_seen(const pl_rings *rings, const pl_rings_ray *ray,
                             const pl_rings_sun *sun) {
  pl_rings_piece pieces[PL_RINGS_PIECES];
  pl_rings_light sum = {.transmittance = 1.0};
  const size_t count = pl_rings_cut(rings, ray, pieces);
  for (size_t i = 0; i < count; i++) {
    const double fraction = pieces[i].fraction;
    const pl_rings_light light = pl_rings_scatter(rings, &pieces[i], ray->direction, sun);
    sum.transmittance -= fraction * (1.0 - light.transmittance);
    for (int k = 0; k < 3; k++)
      sum.scattered[k] += fraction * light.scattered[k];
  }
  sum.transmittance = fmax(0.0, sum.transmittance);
  return sum;
}

double pl_rings_passed(const pl_rings *rings, const pl_rings_ray *ray) {
  pl_rings_piece pieces[PL_RINGS_PIECES];
  double held = 0.0;
  const size_t count = pl_rings_cut(rings, ray, pieces);
  for (size_t i = 0; i < count; i++)
    held +=
        pieces[i].fraction *
        pl_rings_average(rings, pieces[i].low_m, pieces[i].high_m, 1.0 / pieces[i].sine).opacity;
  return fmax(0.0, 1.0 - held);
}
