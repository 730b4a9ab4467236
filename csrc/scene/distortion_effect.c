/* The effect row `distortion`: rays follow the lens's distortion model. */
#include "plan/effects.h"

#include <math.h>

/* An edge that moves by a pixel changes one pixel from black to white; a smaller shift changes it
 * in proportion. The sRGB encoding is steepest at black: 12.92 (IEC 61966-2-1). */
static const double TOE = 12.92;

static const char *absent(const pl_view *view) {
  return view->lens_shift_px > 0.0 ? NULL : "the camera has no lens model, or it displaces nothing";
}

static double bound_dn(const pl_view *view, int value) {
  if (value > 0)
    return 0.0;
  return 255.0 * (view->sun_in_frame ? 1.0 : fmin(1.0, TOE * view->lens_shift_px));
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 1e-4 * view->width * view->height * view->samples;
}

const pl_effect pl_effect_distortion = {
    .name = "distortion",
    .doc = "Lens distortion, for colour and labels; off: a pinhole camera",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
