/* The effect rows `terrain` and `far_casters`: heights of bodies, and shadows from beyond the
 * frame.
 */
#include <math.h>

#include "plan/effects.h"
#include "plan/view_tree.h"

static double rough_light(const pl_view_thing *source, const void *context) {
  (void)context;
  return source->terrain ? pl_view_light(source) : 0.0;
}

static const char *terrain_absent(const pl_view *view) {
  for (size_t i = 0; i < view->thing_count; i++)
    if (view->things[i].terrain)
      return NULL;
  return "no body in the scene has terrain";
}

/* Upper bound of the radiance of ground: slopes and shadows can add or remove all of its light. */
static double own(const pl_view *view, size_t i) {
  const pl_view_thing *thing = &view->things[i];
  if (!thing->diffuse)
    return view->white_radiance;
  const double direct = thing->albedo_max * thing->irradiance / 3.14159265358979;
  return (direct + thing->emission_max + pl_view_received(view, i)) *
         pl_view_series(view, view->max_bounces + 1);
}

/* Ground that is seen, and the light of ground on what is seen. */
static double bound_dn(const pl_view *view, int value) {
  double radiance = 0.0;
  if (value > 0)
    return 0.0;
  pl_view_weigh(view, rough_light, NULL);
  for (size_t i = 0; i < view->thing_count && radiance < view->white_radiance; i++) {
    const pl_view_thing *thing = &view->things[i];
    if (!thing->in_frame)
      continue;
    const double indirect =
        pl_view_sum(view, thing, rough_light, NULL) * pl_view_series(view, view->max_bounces);
    radiance = fmax(radiance, indirect + (thing->terrain ? own(view, i) : 0.0));
  }
  return pl_view_dn(view, radiance);
}

static double terrain_cost_ms(const pl_view *view, int value) {
  (void)value;
  return 3e-4 * view->width * view->height * view->samples;
}

static double casters_cost_ms(const pl_view *view, int value) {
  (void)value;
  return 1e-4 * view->width * view->height;
}

const pl_effect pl_effect_terrain = {
    .name = "terrain",
    .doc = "Heights of bodies with terrain; off: their smooth ellipsoids, also in labels",
    .absent = terrain_absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = terrain_cost_ms,
};

const pl_effect pl_effect_far_casters = {
    .name = "far_casters",
    .doc = "Fine terrain outside the frame that can throw shadows into it; off: coarse there",
    .absent = terrain_absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = casters_cost_ms,
};
