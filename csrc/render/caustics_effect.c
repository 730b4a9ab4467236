/* The effect row `caustics`: sunlight that mirrors reflect onto other surfaces. */
#include <math.h>
#include <stddef.h>

#include "render/caustics.h"
#include "plan/effects.h"

static const double PI = 3.14159265358979323846;

static bool mirrors(const pl_view_entity *entity) {
  return !entity->is_world &&
         (entity->ggx_alpha_min < PL_CAUSTIC_ALPHA_MAX || entity->coat_max > 0.0);
}

static const char *absent(const pl_view *view) {
  if (view->max_bounces == 0)
    return "max_bounces is 0";
  for (size_t i = 0; i < view->entity_count; i++)
    if (mirrors(&view->entities[i]))
      return NULL;
  return "no mesh is smooth enough to mirror the sun";
}

/* Without the row, sunlight reflected by mirrors is found by BSDF sampling only. An entity receives
 * at most the sun's own radiance from them, over the part of its sky that they fill. */
static double bound_dn(const pl_view *view, int value) {
  double radiance = 0.0;
  if (value > 0)
    return 0.0;
  for (size_t i = 0; i < view->entity_count; i++) {
    const pl_view_entity *seen = &view->entities[i];
    for (size_t k = 0; seen->in_frame && k < view->entity_count; k++) {
      const pl_view_entity *source = &view->entities[k];
      if (!mirrors(source))
        continue;
      if (source == seen)
        return pl_view_dn(view, view->white_radiance); /* its parts light each other */
      const double disc = PI * view->sun_radius_rad * view->sun_radius_rad;
      radiance = fmax(radiance, pl_view_transfer(seen, source) * source->irradiance / disc);
    }
  }
  return pl_view_dn(view, radiance * pl_view_series(view, view->max_bounces));
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 2e-5 * view->width * view->height * view->samples;
}

const pl_effect pl_effect_caustics = {
    .name = "caustics",
    .doc = "Sunlight that flat, mirror-like parts reflect onto others, sampled directly; off: "
           "found by chance, as noise",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
