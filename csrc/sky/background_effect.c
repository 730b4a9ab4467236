/* The effect row `sky_background`. */
#include "plan/effects.h"

static const char *absent(const pl_view *view) {
  return view->sky.has_background ? NULL : "there is no background";
}

static double bound_dn(const pl_view *view, int value) {
  return value > 0 ? 0.0 : pl_view_sky_dn(view, view->sky.background_max);
}

static double cost_ms(const pl_view *view, int value) {
  return 3e-4 * view->width * view->height * value;
}

const pl_effect pl_effect_sky_background = {
    .name = "sky_background",
    .doc = "A sky map or an image behind everything",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
