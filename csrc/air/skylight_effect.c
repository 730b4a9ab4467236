/* The effect row `skylight`: light from the sky on a body's ground. */
#include "plan/effects.h"

#include <math.h>

#include "air/light_bounds.h"

static const char *absent(const pl_view *view) { return pl_effect_atmosphere.absent(view); }

static double bound_dn(const pl_view *view, int value) {
  double radiance = 0.0;
  for (size_t i = 0; value == 0 && i < view->entity_count; i++) {
    const pl_view_entity *body = &view->entities[i];
    const double fraction = pl_air_fraction(view, body);
    if (fraction > 0.0)
      radiance += fraction * body->albedo_max * body->irradiance *
                  pl_air_light_bounds_of(body->air).sky / 3.14159265358979;
  }
  return pl_view_dn(view, radiance);
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 2e-5 * view->width * view->height;
}

const pl_effect pl_effect_skylight = {
    .name = "skylight",
    .doc = "Light of the sky on the ground of a body with an atmosphere; off: direct sunlight "
           "only",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
