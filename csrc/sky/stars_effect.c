/* The effect row `stars`. */
#include "plan/effects.h"

static const char *absent(const pl_view *view) {
  return view->sky.catalogued ? NULL : "there is no star catalogue";
}

static int ceiling(const pl_view *view) {
  return view->sky.star_levels > 1 ? view->sky.star_levels : 1;
}

/* Upper bound of the total contribution of the omitted stars to one pixel. */
static double bound_dn(const pl_view *view, int value) {
  const int level = value < view->sky.star_levels ? value : view->sky.star_levels;
  return pl_view_sky_dn(view, (double)view->sky.star_left[level]);
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 2e-3 * (double)view->sky.star_count;
}

const pl_effect pl_effect_stars = {
    .name = "stars",
    .doc = "Stars of the catalogue; the value counts tenths of a magnitude from the brightest in "
           "the frame to the faintest that is rendered",
    .absent = absent,
    .ceiling = ceiling,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
