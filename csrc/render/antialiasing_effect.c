/* The effect row `antialiasing`: the number of colour samples per pixel. */
#include "plan/effects.h"

#include <math.h>

static const char *absent(const pl_view *view) {
  if (view->sun_in_frame)
    return NULL;
  for (size_t i = 0; i < view->entity_count; i++)
    if (view->entities[i].in_frame || pl_view_shows_rings(&view->entities[i]))
      return NULL;
  for (size_t i = 0; i < view->volume_count; i++)
    if (view->volumes[i].in_frame)
      return NULL;
  return "the frame is empty";
}

static int ceiling(const pl_view *view) { return view->samples; }

/* For a pixel on an edge, one sample is off by at most the whole step, and n stratified samples by
 * at most 1/sqrt(n) of it (the discrepancy of half planes). Glints reach the display's white. */
static double bound_dn(const pl_view *view, int value) {
  if (view->target_dn > 0.0 && value < view->samples)
    return 255.0; /* the samples of each pixel are chosen when it is rendered */
  return pl_view_dn(view, pl_view_step(view) / sqrt(value > 0 ? value : 1));
}

static double cost_ms(const pl_view *view, int value) {
  return 3e-4 * view->width * view->height * value;
}

const pl_effect pl_effect_antialiasing = {
    .name = "antialiasing",
    .doc = "Monte Carlo samples per pixel: the error is about that of this many in every pixel. "
           "Quiet pixels, to within three tolerances, get fewer, outlines up to twice as many. "
           "Off: one through the centre",
    .absent = absent,
    .ceiling = ceiling,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
