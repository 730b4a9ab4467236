/* The effect row `cast_shadows`. */
#include "render/effects.h"

#include <stddef.h>

/* A caster that can darken something in the frame; a body alone is convex and shades only itself,
 * which is part of every reflectance. */
static bool has_caster(const pl_view *view) {
  for (size_t i = 0; i < view->thing_count; i++) {
    if (!view->things[i].in_frame)
      continue;
    for (size_t k = 0; k < view->thing_count; k++) {
      if (k == i && view->things[k].is_body)
        continue;
      if (pl_view_shadow_reaches(view, &view->things[k], &view->things[i]))
        return true;
    }
  }
  return false;
}

static const char *absent(const pl_view *view) {
  return has_caster(view) ? NULL : "no shadow can fall on anything in the frame";
}

static double bound_dn(const pl_view *view, int value) {
  if (value > 0)
    return 0.0;
  const bool glossy = pl_view_alpha_min(view) < 1.0;
  return pl_view_dn(view, glossy ? view->white_radiance : pl_view_radiance_max(view));
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
