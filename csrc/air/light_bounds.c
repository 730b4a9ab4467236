/* Upper bounds of the effect of a body's atmosphere. */
#include "air/light_bounds.h"

#include <math.h>
#include <stddef.h>

#include "air/table.h"

/* Maximum of the Mie phase function: forward or backward scattering. */
static double peak(const pl_air_settings *s) {
  double largest = 0.0;
  for (int k = 0; k < 3; k++)
    largest = fmax(largest,
                   (double)pl_air_mie_phase(s->mie_g[k] < 0.0 ? -1.0f : 1.0f, (float)s->mie_g[k]));
  return largest;
}

/* Optical depth of one constituent along the longest path, in the band where it is largest. */
static double longest(const pl_air *air, int part) {
  float column[PL_AIR_PARTS], most = 0.0f;
  const pl_air_place ground = pl_air_place_of(air, 0.0);
  pl_air_column_up(air, &ground, 0.0, column);
  for (int k = 0; k < 3; k++)
    most = pl_maxf(most, air->extinction[part][k]);
  return 2.0 * (double)(column[part] * most);
}

/* Light scattered along a ray is less than the light lost along it, times the phase function. On an
 * oblate body, rays may be longer than the mean radius gives, by less than this factor. */
static const double OBLATE = 1.1;

/* What is scattered again is at most the largest value of the phase function times the field that
 * it is scattered from, and isotropic here: off by the difference of the two at most. Rayleigh's
 * phase function is 0.75 to 1.5 times the isotropic one. */
static double again_of(const pl_air *air, const double depths[2], double most) {
  const double gas = 0.5, haze = fmax(4.0 * PL_PI * peak(&air->settings) - 1.0, 0.25);
  return most * (gas * -expm1(-depths[0]) + haze * -expm1(-depths[1]));
}

void pl_air_build_light_bounds(pl_air *air) {
  pl_air_light_bounds out = {0};
  const double depths[2] = {OBLATE * longest(air, 0), OBLATE * longest(air, 1)};
  /* factor 2 because the layer lies above the ground */
  const double ozone = OBLATE * 2.0 * longest(air, 2);
  out.depth = depths[0] + depths[1] + ozone;
  const double rayleigh = (double)pl_air_rayleigh_phase(1.0f);
  out.scattered = rayleigh * -expm1(-depths[0]) + peak(&air->settings) * -expm1(-depths[1]);
  double largest = 0.0;
  for (int i = 0; i < PL_AIR_MULTIPLE_HEIGHTS; i++)
    for (int k = 0; k < PL_AIR_MULTIPLE_SINES; k++)
      largest = fmax(largest, (double)pl_vec3f_max(air->several[i][k]));
  out.several = largest * -expm1(-depths[0] - depths[1]);
  out.again = again_of(air, depths, largest);
  for (int k = 0; k < PL_AIR_SKY; k++)
    out.sky = fmax(out.sky, (double)pl_vec3f_max(air->sky[1][k]));
  pl_air_measure_steps(air, out.depth, out.steps_off);
  air->bounds = out;
}

pl_air_light_bounds pl_air_light_bounds_of(const pl_air *air) { return air->bounds; }

double pl_air_fraction(const pl_view *view, const pl_view_entity *body) {
  if (body->air == NULL)
    return 0.0;
  if (body->air_in_frame)
    return 1.0;
  return pl_view_shell_fraction(
      view, body, body->radius_m * (1.0 + body->air->settings.top_m / body->air->radius_m));
}
