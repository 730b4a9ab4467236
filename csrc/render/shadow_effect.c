/* The effect row `cast_shadows`. */
#include "plan/effects.h"
#include "plan/view_tree.h"

#include <math.h>
#include <stddef.h>

static const char *absent(const pl_view *view) {
  for (size_t i = 0; i < view->entity_count; i++)
    if ((view->entities[i].in_frame || view->max_bounces > 0) && pl_view_shadowed(view, i))
      return NULL;
  return "no shadow can fall on anything in the frame";
}

/* Light from an object or body that shadows may fall on. */
static double shadowed_light(const pl_view_entity *source, const void *context) {
  const pl_view *view = context;
  return pl_view_shadowed(view, (size_t)(source - view->entities)) ? pl_view_light(source) : 0.0;
}

/* A shadow in the frame may remove all direct light. Shadows elsewhere remove the light that the
 * shadowed surfaces would reflect into the frame. */
static double bound_dn(const pl_view *view, int value) {
  double radiance = 0.0;
  if (value > 0)
    return 0.0;
  const double series = pl_view_series(view, view->max_bounces);
  pl_view_weigh(view, shadowed_light, view);
  for (size_t i = 0; i < view->entity_count && radiance < view->white_radiance; i++) {
    const pl_view_entity *entity = &view->entities[i];
    if (!entity->in_frame)
      continue;
    if (pl_view_shadowed(view, i))
      radiance = fmax(radiance, entity->ggx_alpha_min < 1.0
                                    ? view->white_radiance
                                    : entity->albedo_max * entity->irradiance / 3.14159265358979);
    /* and the light that reaches it from others that shadows fall on */
    radiance = fmax(radiance, pl_view_sum(view, entity, shadowed_light, view) * series);
  }
  return pl_view_dn(view, radiance);
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 1.5e-4 * view->width * view->height * view->samples;
}

const pl_effect pl_effect_cast_shadows = {
    .name = "cast_shadows",
    .doc = "Shadows and eclipses: shadow rays to the sun are tested against meshes and bodies",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
