/* The effect row `bump_detail`: normal maps and bumps. */
#include <math.h>

#include "shade/effects.h"

static const char *absent(const pl_view *view) {
  for (size_t i = 0; i < view->thing_count; i++)
    if (view->things[i].bumped)
      return NULL;
  return "no normal in the scene is bent";
}

/* Through the light that bent normals send onto things[i]. */
static double indirect(const pl_view *view, size_t i) {
  double radiance = 0.0;
  for (size_t k = 0; k < view->thing_count; k++)
    if (k != i && view->things[k].bumped)
      radiance +=
          pl_view_transfer(&view->things[i], &view->things[k]) * pl_view_light(&view->things[k]);
  return radiance * pl_view_series(view, view->max_bounces);
}

/* All that a diffuse surface receives comes and goes with the normal; a glossy one can turn to the
 * sun. */
static double own(const pl_view *view, size_t i) {
  const pl_view_thing *thing = &view->things[i];
  if (!thing->diffuse)
    return view->white_radiance;
  const double direct = thing->albedo_max * thing->irradiance / 3.14159265358979;
  return (direct + thing->emission_max + pl_view_received(view, i)) *
         pl_view_series(view, view->max_bounces + 1);
}

static double bound_dn(const pl_view *view, int value) {
  double radiance = 0.0;
  if (value > 0)
    return 0.0;
  for (size_t i = 0; i < view->thing_count; i++)
    if (view->things[i].in_frame)
      radiance = fmax(radiance, indirect(view, i) + (view->things[i].bumped ? own(view, i) : 0.0));
  return pl_view_dn(view, radiance);
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 1e-4 * view->width * view->height * view->samples;
}

const pl_effect pl_effect_bump_detail = {
    .name = "bump_detail",
    .doc = "Normals bent by normal maps and bumps; off: those of the mesh",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
