/* The effect row `surface_maps`: textures and maps instead of their means. */
#include "shade/effects.h"

#include <math.h>
#include <stddef.h>

static const char *absent(const pl_view *view) {
  for (size_t i = 0; i < view->thing_count; i++)
    if (view->things[i].textured)
      return NULL;
  return "nothing in the scene has a map";
}

/* In the frame a map can change everything up to the brightest diffuse radiance; outside it acts
 * through the light that it reflects, by its view factor from what is in the frame. */
static double bound_dn(const pl_view *view, int value) {
  if (value > 0)
    return 0.0;
  double radiance = 0.0;
  for (size_t i = 0; i < view->thing_count; i++) {
    const pl_view_thing *source = &view->things[i];
    if (!source->textured)
      continue;
    const double diffuse = source->albedo_max * source->irradiance / 3.14159265358979;
    /* A roughness map can turn a dull surface into a mirror of the sun. */
    const double own = source->is_body ? diffuse : fmax(diffuse, view->white_radiance);
    if (source->in_frame)
      radiance = own > radiance ? own : radiance;
    for (size_t k = 0; k < view->thing_count; k++) {
      const pl_view_thing *receiver = &view->things[k];
      if (k == i || !receiver->in_frame || view->max_bounces == 0)
        continue;
      const double reflected = own * receiver->albedo_max * pl_view_factor(receiver, source);
      radiance = reflected > radiance ? reflected : radiance;
    }
  }
  return pl_view_dn(view, radiance);
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 5e-5 * view->width * view->height * view->samples;
}

const pl_effect pl_effect_surface_maps = {
    .name = "surface_maps",
    .doc = "Colour, roughness, normal and emission maps; off: each counts as its mean",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
