/* The effect row `emitters`: emissive surfaces and bodies illuminate others. */
#include "plan/effects.h"
#include "plan/view_tree.h"

#include <math.h>

static const char *absent(const pl_view *view) {
  for (size_t i = 0; i < view->entity_count; i++)
    if (view->entities[i].emission_max > 0.0 &&
        (view->entity_count > 1 || !view->entities[i].is_body))
      return NULL;
  return "nothing in the scene emits light onto anything";
}

/* 1: emitters illuminate meshes, 2: bodies too. */
static int ceiling(const pl_view *view) {
  (void)view;
  return 2;
}

static double emitted(const pl_view_entity *source, const void *context) {
  (void)context;
  return source->emission_max;
}

/* Upper bound of the radiance that entities[i] reflects in any direction of the light that it
 * receives from emitters. A mesh may illuminate itself. */
static double sent_on(const pl_view *view, size_t i) {
  const pl_view_entity *receiver = &view->entities[i];
  const double own = receiver->is_body ? 0.0 : pl_view_transfer(receiver, receiver);
  return pl_view_sum(view, receiver, emitted, NULL) + own * receiver->emission_max;
}

/* Receivers that are not illuminated at `value` lack light both as seen in the frame and in what
 * they reflect onto others. */
static double bound_dn(const pl_view *view, int value) {
  double radiance = 0.0;
  pl_view_weigh(view, emitted, NULL);
  for (size_t i = 0; i < view->entity_count && radiance < view->white_radiance; i++) {
    const pl_view_entity *entity = &view->entities[i];
    const bool lit = value > (entity->is_body ? 1 : 0);
    if (!lit && (entity->in_frame || view->max_bounces > 0))
      radiance = fmax(radiance, sent_on(view, i));
  }
  return pl_view_dn(view, radiance * pl_view_series(view, view->max_bounces + 1));
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 2.5e-4 * view->width * view->height * view->samples;
}

const pl_effect pl_effect_emitters = {
    .name = "emitters",
    .doc = "Light of emissive surfaces and bodies on others: 1 on meshes, 2 on bodies too; off: "
           "they are visible but light nothing",
    .absent = absent,
    .ceiling = ceiling,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
