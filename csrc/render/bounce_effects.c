/* The effect rows `bounces` and `body_bounces`: light that arrives by way of other surfaces. */
#include "plan/effects.h"
#include "plan/view_tree.h"

#include <math.h>
#include <stddef.h>

/* True if an entity can receive light from another. A mesh can receive it from itself. */
static bool has_sky(const pl_view *view, const pl_view_entity *entity) {
  return !entity->is_body || view->entity_count > 1 || view->volume_count > 0;
}

static const char *absent(const pl_view *view) {
  if (view->max_bounces == 0)
    return "max_bounces is 0";
  for (size_t i = 0; i < view->entity_count; i++)
    if (view->entities[i].in_frame && has_sky(view, &view->entities[i]))
      return NULL;
  return "nothing in the frame can receive light from anything else";
}

static int ceiling(const pl_view *view) { return view->max_bounces > 0 ? view->max_bounces : 1; }

/* Upper bound of the part of an entity's sky that is filled by other entities, or by itself, times
 * its albedo. */
static double return_of(const pl_view *view, const pl_view_entity *entity) {
  if (!entity->is_body)
    return fmin(entity->albedo_max, 1.0); /* its sky may be filled by itself */
  double sum = pl_view_sum_sky(view, entity);
  for (size_t k = 0; (view->tree == NULL || view->tree->ringed) && k < view->entity_count; k++) {
    if (&view->entities[k] == entity || view->entities[k].rings == NULL)
      continue;
    const pl_view_entity rings = pl_view_ring_sphere(&view->entities[k]);
    sum += pl_view_transfer(entity, &rings);
  }
  return fmin(1.0, sum);
}

/* Upper bound of the light of paths with more than `value` bounces: a geometric series, as each
 * bounce keeps at most the largest return. Paths on bodies have one more bounce from the row
 * `body_bounces`. */
static double bound_dn(const pl_view *view, int value) {
  double largest = 0.0, light = 0.0, radiance = 0.0, volumes = 0.0;
  for (size_t i = 0; i < view->entity_count; i++) {
    largest = fmax(largest, return_of(view, &view->entities[i]));
    volumes = fmax(volumes, pl_view_from_volumes(view, &view->entities[i]));
    light = fmax(light, pl_view_light_most(view, &view->entities[i]));
    if (view->entities[i].rings != NULL)
      light = fmax(light, view->entities[i].rings->light);
  }
  for (size_t i = 0; i < view->entity_count; i++) {
    const pl_view_entity *entity = &view->entities[i];
    if (!entity->in_frame || !has_sky(view, entity))
      continue;
    if (largest >= 1.0 || entity->ggx_alpha_min < 1.0)
      return pl_view_dn(view, view->white_radiance); /* may reflect the sun itself */
    const double bounces = entity->is_body && value == 0 ? 1 : value;
    const double all = (return_of(view, entity) * light + volumes) / (1.0 - largest);
    radiance = fmax(radiance, all * pow(largest, bounces));
  }
  return pl_view_dn(view, radiance);
}

static double cost_ms(const pl_view *view, int value) {
  return 1.5e-4 * view->width * view->height * view->samples * value;
}

const pl_effect pl_effect_bounces = {
    .name = "bounces",
    .doc = "Light reflected between surfaces, as seen on meshes; the value is the number of "
           "bounces",
    .absent = absent,
    .ceiling = ceiling,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};

static const char *body_absent(const pl_view *view) {
  if (view->max_bounces == 0)
    return "max_bounces is 0";
  for (size_t i = 0; i < view->entity_count; i++)
    if (view->entities[i].in_frame && view->entities[i].is_body &&
        has_sky(view, &view->entities[i]))
      return NULL;
  return "no body in the frame can receive light from anything else";
}

/* Upper bound of the light that sources reflect onto bodies, by their view factors. */
static double body_bound_dn(const pl_view *view, int value) {
  if (value > 0)
    return 0.0;
  double radiance = 0.0;
  for (size_t i = 0; i < view->entity_count && radiance < view->white_radiance; i++) {
    const pl_view_entity *receiver = &view->entities[i];
    if (!receiver->in_frame || !receiver->is_body)
      continue;
    radiance = fmax(radiance, pl_view_received(view, i));
  }
  return pl_view_dn(view, radiance * pl_view_series(view, view->max_bounces));
}

static double body_cost_ms(const pl_view *view, int value) {
  (void)value;
  return 1.5e-4 * view->width * view->height * view->samples;
}

const pl_effect pl_effect_body_bounces = {
    .name = "body_bounces",
    .doc = "Light that other things reflect onto bodies; off: paths end on bodies",
    .absent = body_absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = body_bound_dn,
    .cost_ms = body_cost_ms,
};
