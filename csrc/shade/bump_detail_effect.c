/* The effect rows `bump_detail` and `relief`: normals changed by normal maps and bumps. */
#include <math.h>

#include "plan/effects.h"
#include "plan/view_tree.h"

typedef bool (*bends_fn)(const pl_view_thing *thing);
static bool is_bumped(const pl_view_thing *thing) { return thing->bumped; }
static bool has_relief(const pl_view_thing *thing) { return thing->relief; }

static bool any(const pl_view *view, bends_fn bends) {
  for (size_t i = 0; i < view->thing_count; i++)
    if (bends(&view->things[i]))
      return true;
  return false;
}

static double bent_light(const pl_view_thing *source, const void *context) {
  const bends_fn *bends = context;
  return (*bends)(source) ? pl_view_light(source) : 0.0;
}

/* Upper bound of the indirect light that surfaces with bumped normals send onto things[i]. */
static double indirect(const pl_view *view, bends_fn bends, size_t i) {
  return pl_view_sum(view, &view->things[i], bent_light, &bends) *
         pl_view_series(view, view->max_bounces);
}

/* Upper bound of the change of an object's own radiance: a diffuse surface can gain or lose all
 * light that it receives, a glossy one can reflect the sun to the camera. */
static double own(const pl_view *view, size_t i) {
  const pl_view_thing *thing = &view->things[i];
  if (!thing->diffuse)
    return view->white_radiance;
  const double direct = thing->albedo_max * thing->irradiance / 3.14159265358979;
  return (direct + thing->emission_max + pl_view_received(view, i)) *
         pl_view_series(view, view->max_bounces + 1);
}

static double bound_dn(const pl_view *view, bends_fn bends) {
  double radiance = 0.0;
  pl_view_weigh(view, bent_light, &bends);
  for (size_t i = 0; i < view->thing_count && radiance < view->white_radiance; i++)
    if (view->things[i].in_frame)
      radiance =
          fmax(radiance, indirect(view, bends, i) + (bends(&view->things[i]) ? own(view, i) : 0.0));
  return pl_view_dn(view, radiance);
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 1e-4 * view->width * view->height * view->samples;
}

static const char *bump_absent(const pl_view *view) {
  return any(view, is_bumped) ? NULL : "nothing in the scene has a normal map or bump";
}

static double bump_bound_dn(const pl_view *view, int value) {
  return value > 0 ? 0.0 : bound_dn(view, is_bumped);
}

const pl_effect pl_effect_bump_detail = {
    .name = "bump_detail",
    .doc = "Normal maps and bumps; off: the normals of the mesh",
    .absent = bump_absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bump_bound_dn,
    .cost_ms = cost_ms,
};

static const char *relief_absent(const pl_view *view) {
  return any(view, has_relief) ? NULL : "no body in the scene has relief";
}

static double relief_bound_dn(const pl_view *view, int value) {
  return value > 0 ? 0.0 : bound_dn(view, has_relief);
}

const pl_effect pl_effect_relief = {
    .name = "relief",
    .doc = "Height and normal maps of bodies; off: a smooth surface",
    .absent = relief_absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = relief_bound_dn,
    .cost_ms = cost_ms,
};
