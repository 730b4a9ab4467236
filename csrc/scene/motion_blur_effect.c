/* The effect row `motion_blur`: the exposure as the mean of several instants. */
#include "plan/effects.h"

#include <math.h>

/* Motion of fewer pixels counts as none. */
static const double STILL_PX = 0.1;
/* Instants per pixel of motion, and their limit. */
static const double PER_PX = 4.0;
enum { INSTANTS_MAX = 256 };

static const char *absent(const pl_view *view) {
  if (!(view->blur_px > 0.0))
    return "the exposure time is zero, or nothing moves";
  return view->blur_px < STILL_PX ? "nothing moves by a tenth of a pixel" : NULL;
}

static int ceiling(const pl_view *view) {
  const double wanted = ceil(PER_PX * view->blur_px);
  return wanted >= INSTANTS_MAX ? INSTANTS_MAX : wanted > 2.0 ? (int)wanted : 2;
}

/* The middle of each of n parts of the exposure represents the part: light in it is displaced by up
 * to 1/2n of the motion, 1/4n in the mean. */
static double bound_dn(const pl_view *view, int value) {
  return pl_view_dn_shift(view, view->blur_px / (4.0 * (value > 0 ? value : 1)));
}

/* Every instant needs its own tree of instances and its own pass over the tiles. */
static double cost_ms(const pl_view *view, int value) {
  return value * (0.1 + 0.02 * (double)view->entity_count + 1e-5 * view->width * view->height);
}

const pl_effect pl_effect_motion_blur = {
    .name = "motion_blur",
    .doc = "Blur by motion during the exposure; the value is the number of instants, at most "
           "256. The samples of each pixel are spread over the instants; labels are valid in the "
           "middle",
    .absent = absent,
    .ceiling = ceiling,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
