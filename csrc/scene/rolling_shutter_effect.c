/* The effect row `rolling_shutter`: rows are exposed one after the other. */
#include "plan/effects.h"

#include <math.h>

/* Motion of fewer pixels between the first row and the last counts as none. */
static const double STILL_PX = 0.1;

static const char *absent(const pl_view *view) {
  if (!(view->skew_px > 0.0))
    return "all rows are exposed at once, or nothing moves";
  return view->skew_px < STILL_PX
             ? "nothing moves by a tenth of a pixel from the first row to the last"
             : NULL;
}

static int ceiling(const pl_view *view) { return view->skew_px > 0.0 ? view->height : 1; }

/* The instant at which a row is rendered is off by at most half of the rows of its band; without
 * bands by half the rows of the image. */
static double bound_dn(const pl_view *view, int value) {
  const double rows = ceil((double)view->height / (value > 0 ? value : 1));
  const double gaps = view->height > 1 ? view->height - 1.0 : 1.0;
  return pl_view_dn_shift(view, 0.5 * view->skew_px * (rows - 1.0) / gaps);
}

static double cost_ms(const pl_view *view, int value) {
  return value * (0.1 + 0.02 * (double)view->entity_count);
}

const pl_effect pl_effect_rolling_shutter = {
    .name = "rolling_shutter",
    .doc = "Rows exposed one after the other, for colour and labels; the value is the number of "
           "row bands, each at its own instant",
    .absent = absent,
    .ceiling = ceiling,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
