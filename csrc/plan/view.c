/* Quantities that several effects' bounds share. */
#include "plan/view.h"

#include <math.h>

/* IEC 61966-2-1 */
static double encode(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1.0 / 2.4) - 0.055;
}

double pl_view_dn(const pl_view *view, double radiance) {
  const double linear = radiance / view->white_radiance;
  if (!(linear > 0.0))
    return 0.0;
  return linear >= 1.0 ? 255.0 : 255.0 * encode(linear);
}

double pl_view_dn_dimming(double fraction) {
  /* x -> (1 - f) x moves the encoding most at x = 1, where its slope is 1.055/2.4. */
  return fraction >= 1.0 ? 255.0 : 255.0 * (1.0 - encode(1.0 - fraction));
}

double pl_view_hidden_sun(const pl_view *view, const pl_view_thing *caster,
                          const pl_view_thing *receiver) {
  double square = 0.0;
  for (int k = 0; k < 3; k++)
    square += pow(receiver->center_m[k] - caster->center_m[k], 2.0);
  const double gap = sqrt(square) - receiver->radius_m;
  if (!pl_view_shadow_reaches(view, caster, receiver))
    return 0.0;
  if (gap <= caster->radius_m || !(view->sun_radius_rad > 0.0))
    return 1.0;
  const double ratio = asin(caster->radius_m / gap) / view->sun_radius_rad;
  return fmin(1.0, ratio * ratio);
}

double pl_view_radiance_max(const pl_view *view) {
  double largest = 0.0;
  for (size_t i = 0; i < view->thing_count; i++) {
    const pl_view_thing *thing = &view->things[i];
    if (thing->in_frame)
      largest = fmax(largest, thing->albedo_max * thing->irradiance / 3.14159265358979);
  }
  return largest;
}

double pl_view_alpha_min(const pl_view *view) {
  double smallest = 1.0;
  for (size_t i = 0; i < view->thing_count; i++)
    if (view->things[i].in_frame)
      smallest = fmin(smallest, view->things[i].ggx_alpha_min);
  return smallest;
}

bool pl_view_shadow_reaches(const pl_view *view, const pl_view_thing *caster,
                            const pl_view_thing *receiver) {
  double along = 0.0, square = 0.0;
  for (int k = 0; k < 3; k++) {
    const double offset = receiver->center_m[k] - caster->center_m[k];
    along -= offset * view->sun_direction[k]; /* distance behind the caster, away from the sun */
    square += offset * offset;
  }
  const double reach = caster->radius_m + receiver->radius_m;
  if (along < -reach)
    return false;
  /* Parallax of the sun between the things is covered by doubling the penumbra's opening. */
  const double opening = 2.0 * tan(view->sun_radius_rad) * (fabs(along) + reach);
  const double across = sqrt(fmax(0.0, square - along * along));
  return across < reach + opening;
}

double pl_view_factor(const pl_view_thing *receiver, const pl_view_thing *source) {
  double square = 0.0;
  for (int k = 0; k < 3; k++) {
    const double offset = receiver->center_m[k] - source->center_m[k];
    square += offset * offset;
  }
  const double gap = sqrt(square) - receiver->radius_m;
  if (gap <= source->radius_m)
    return 1.0;
  return source->radius_m * source->radius_m / (gap * gap);
}
