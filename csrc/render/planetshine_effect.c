/* The effect row `planetshine`: bodies as lights of others. */
#include "plan/effects.h"

#include <math.h>
#include <stddef.h>

static const char *absent(const pl_view *view) {
  size_t bodies = 0;
  bool seen = false;
  for (size_t i = 0; i < view->thing_count; i++) {
    bodies += view->things[i].is_world;
    seen = seen || view->things[i].in_frame;
  }
  if (view->max_bounces == 0)
    return "max_bounces is 0";
  if (bodies == 0)
    return "there is no body";
  if (view->thing_count < 2)
    return "the body has nothing to light";
  return seen ? NULL : "nothing is in the frame";
}

/* Upper bound of what a thing sends on of the sun's light that bodies give it by one reflection. */
static double sent_on(const pl_view *view, const pl_view_thing *receiver) {
  double sum = 0.0;
  for (size_t k = 0; k < view->thing_count; k++) {
    const pl_view_thing *body = &view->things[k];
    if (body->is_world && body != receiver)
      sum += pl_view_transfer(receiver, body) * (pl_view_light(body) - body->emission_max);
  }
  return sum;
}

/* What things in the frame get from bodies, and by way of others what these get; bodies may be
 * brighter by what others give them. */
static double bound_dn(const pl_view *view, int value) {
  double seen = 0.0, any = 0.0;
  if (value > 0)
    return 0.0;
  for (size_t i = 0; i < view->thing_count; i++) {
    const double sent = sent_on(view, &view->things[i]);
    any = fmax(any, sent);
    seen = view->things[i].in_frame ? fmax(seen, sent) : seen;
  }
  const double series = pl_view_series(view, view->max_bounces);
  return pl_view_dn(view, seen + any * (series * series - 1.0));
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 1e-4 * view->width * view->height * view->samples;
}

const pl_effect pl_effect_planetshine = {
    .name = "planetshine",
    .doc = "Light that surfaces of bodies reflect onto other things; that of their clouds, rings "
           "and air is in the rows of these",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
