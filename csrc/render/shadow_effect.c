/* The effect row `cast_shadows`. */
#include "plan/effects.h"

#include <math.h>
#include <stddef.h>

static const char *absent(const pl_view *view) {
  for (size_t i = 0; i < view->thing_count; i++)
    if ((view->things[i].in_frame || view->max_bounces > 0) && pl_view_shadowed(view, i))
      return NULL;
  return "no shadow can fall on anything in the frame";
}

/* Light that reaches `receiver` by way of things that shadows fall on. */
static double indirect(const pl_view *view, size_t receiver) {
  double radiance = 0.0;
  for (size_t k = 0; k < view->thing_count; k++)
    if (k != receiver && pl_view_shadowed(view, k))
      radiance += pl_view_transfer(&view->things[receiver], &view->things[k]) *
                  pl_view_light(&view->things[k]);
  return radiance * pl_view_series(view, view->max_bounces);
}

/* A shadow in the frame takes all direct light; others take what the shadowed things reflect. */
static double bound_dn(const pl_view *view, int value) {
  double radiance = 0.0;
  if (value > 0)
    return 0.0;
  for (size_t i = 0; i < view->thing_count; i++) {
    const pl_view_thing *thing = &view->things[i];
    if (!thing->in_frame)
      continue;
    if (pl_view_shadowed(view, i))
      radiance = fmax(radiance, thing->ggx_alpha_min < 1.0
                                    ? view->white_radiance
                                    : thing->albedo_max * thing->irradiance / 3.14159265358979);
    radiance = fmax(radiance, indirect(view, i));
  }
  return pl_view_dn(view, radiance);
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 1.5e-4 * view->width * view->height * view->samples;
}

const pl_effect pl_effect_cast_shadows = {
    .name = "cast_shadows",
    .doc = "Shadows and eclipses: sun rays are tested against meshes and bodies",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
