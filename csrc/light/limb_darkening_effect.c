/* The effect row `limb_darkening`: the sun's disc with limb darkening instead of uniform
 * brightness. */
#include "plan/effects.h"

#include <math.h>

#include "light/penumbra.h"

/* Largest differences from a uniform disc over all wavelengths of light/limb.c, by numerical
 * integration (tests/c/test_limb.c), for a disc of radius 1. CHORD: fraction of the light on one
 * side of a chord. MOMENT: first moment of half the disc, which determines the light at the
 * terminator. */
static const double CHORD = 0.0283, MOMENT = 0.0178;
/* Sunlight on surfaces is a weighted mean of the radiance over the disc. Lobes, casters and bounces
 * set the weights, which are not negative. So a dark limb changes this light by a factor between
 * the least and the greatest radiance over the mean radiance: 0.167 and 1.347 over all wavelengths
 * (tests/c/test_limb.c). Of the two discs, uniform and with a dark limb, either gives the other's
 * light less at most this fraction. */
static const double LESS = 0.834;

static const char *absent(const pl_view *view) {
  return view->sun_in_frame ? NULL : pl_effect_soft_sun.absent(view);
}

static double bound_dn(const pl_view *view, int value) {
  if (value > 0)
    return 0.0;
  if (view->sun_in_frame)
    return 255.0;
  if (pl_view_alpha_min(view) < PL_SUN_LOBE_RATIO * view->sun_radius_rad)
    return pl_view_dn_dimming(LESS);
  const double fraction = CHORD * fmin(1.0, pl_penumbra_px(view)) + MOMENT * view->sun_radius_rad;
  return fmin(pl_view_dn(view, fraction * pl_view_radiance_max(view)), pl_view_dn_dimming(LESS));
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 1e-5 * view->width * view->height * view->samples;
}

const pl_effect pl_effect_limb_darkening = {
    .name = "limb_darkening",
    .doc = "The sun's disc darker and redder towards its edge, with soft_sun; off: uniform disc",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
