/* The effect row `multiple_scattering`: light that air scatters more than once. */
#include "plan/effects.h"

#include <math.h>

#include "air/light_bounds.h"

static const char *absent(const pl_view *view) {
  for (size_t i = 0; i < view->entity_count; i++)
    if (pl_air_fraction(view, &view->entities[i]) > 0.0 &&
        pl_air_settings_of(view->entities[i].air)->multiple)
      return NULL;
  return "no atmosphere that is visible or lights anything in the frame has multiple scattering";
}

/* Upper bound of the light that multiple scattering adds to the air and, through skylight, to the
 * ground; of that by which it is off, if it is on. It is off because light that is scattered again
 * is isotropic: on the ground by no more than there is, as at most twice the half that isotropic
 * light sends down can come down. For the field that the light is scattered from; of higher orders
 * the field is off, too, by less than the Monte Carlo of tests/python/test_twilight.py sees. */
static double bound_dn(const pl_view *view, int value) {
  double radiance = 0.0;
  for (size_t i = 0; i < view->entity_count; i++) {
    const pl_view_entity *body = &view->entities[i];
    const double fraction = pl_air_fraction(view, body);
    if (fraction == 0.0)
      continue;
    const pl_air_light_bounds bounds = pl_air_light_bounds_of(body->air);
    const double ground = body->albedo_max * bounds.sky / 3.14159265358979;
    const double off = bounds.again + ground, added = value == 0 ? bounds.several + ground : 0.0;
    radiance += fraction * body->irradiance * (off + added);
  }
  return pl_view_dn(view, radiance);
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 2e-5 * view->width * view->height;
}

const pl_effect pl_effect_multiple_scattering = {
    .name = "multiple_scattering",
    .doc = "Light that air scatters more than once, isotropic from the second time on, so that the "
           "air's light is off by up to 15 % for the Earth's, 40 % for Mars's, and 2 % for gas "
           "alone as deep as the Earth's (docs/air.md); off: single scattering",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
