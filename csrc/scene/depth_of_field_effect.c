/* The effect row `depth_of_field`: a thin lens of finite aperture. */
#include "plan/effects.h"

#include <math.h>

/* Circles of confusion with a smaller diameter, pixels, count as points. */
static const double SHARP_PX = 0.1;

static const char *absent(const pl_view *view) {
  if (!(view->defocus_px > 0.0))
    return "the camera is a pinhole, or everything in the frame is in focus";
  return view->defocus_px < SHARP_PX ? "no blur is as wide as a tenth of a pixel" : NULL;
}

/* Each point of the aperture sees the image shifted. Shifts are uniform over the disc of the circle
 * of confusion: their mean is two thirds of its radius. */
static double bound_dn(const pl_view *view, int value) {
  return value > 0 ? 0.0 : pl_view_dn_shift(view, view->defocus_px / 3.0);
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 5e-5 * view->width * view->height * view->samples;
}

const pl_effect pl_effect_depth_of_field = {
    .name = "depth_of_field",
    .doc = "Defocus blur of a lens with a finite aperture; labels stay sharp",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
