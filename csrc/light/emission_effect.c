/* The effect row `emission`: what emits is seen to. */
#include "light/effects.h"

static const char *absent(const pl_view *view) {
  return pl_view_emission_max(view) > 0.0 ? NULL : "nothing in the frame emits light";
}

/* Added to what the surface reflects: most on black. What others get of it is the row `emitters`.
 */
static double bound_dn(const pl_view *view, int value) {
  return value > 0 ? 0.0 : pl_view_dn(view, pl_view_emission_max(view));
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 1e-6 * view->width * view->height * view->samples;
}

const pl_effect pl_effect_emission = {
    .name = "emission",
    .doc = "Light of emissive surfaces and bodies as the camera sees it; off: they look as others "
           "do, though they may light them",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
