/* The effect row `planetshine`: bodies as light sources for other objects and bodies. */
#include "plan/effects.h"
#include "plan/view_tree.h"

#include <math.h>
#include <stddef.h>

static const char *absent(const pl_view *view) {
  size_t bodies = 0;
  bool seen = false;
  for (size_t i = 0; i < view->entity_count; i++) {
    bodies += view->entities[i].is_world;
    seen = seen || view->entities[i].in_frame;
  }
  if (view->max_bounces == 0)
    return "max_bounces is 0";
  if (bodies == 0)
    return "there is no body";
  if (view->entity_count < 2)
    return "the body has nothing to light";
  return seen ? NULL : "nothing is in the frame";
}

/* Sunlight that a body reflects. */
static double reflected(const pl_view_entity *body, const void *context) {
  const pl_view *view = context;
  return body->is_world ? pl_view_light_most(view, body) - body->emission_max : 0.0;
}

/* Light that objects and bodies in the frame receive from bodies, directly and by way of others
 * that bodies light. Bodies may in turn be brighter through light from others. */
static double bound_dn(const pl_view *view, int value) {
  double seen = 0.0, any = 0.0;
  if (value > 0)
    return 0.0;
  pl_view_weigh(view, reflected, view);
  for (size_t i = 0; i < view->entity_count; i++) {
    /* upper bound of the light of bodies that it reflects, by one reflection */
    const double sent = pl_view_sum(view, &view->entities[i], reflected, view);
    any = fmax(any, sent);
    seen = view->entities[i].in_frame ? fmax(seen, sent) : seen;
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
    .doc = "Sunlight that surfaces of bodies reflect onto other things; light of their clouds, "
           "rings and air belongs to the rows of these",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
