/* The effect rows `clear_coat` and `transmission`: layers of surfaces. */
#include <math.h>
#include <stddef.h>

#include "plan/effects.h"
#include "plan/view_tree.h"

static double coat_of(const pl_view_entity *entity) { return entity->coat_max; }
static double passing(const pl_view_entity *entity) { return entity->transmission_max; }

typedef double (*part_fn)(const pl_view_entity *entity);

static bool any(const pl_view *view, part_fn part) {
  for (size_t i = 0; i < view->entity_count; i++)
    if (part(&view->entities[i]) > 0.0)
      return true;
  return false;
}

static double layer_light(const pl_view_entity *source, const void *context) {
  const part_fn *part = context;
  return (*part)(source) > 0.0 ? pl_view_light(source) : 0.0;
}

/* An object in the frame with such a layer can show the sun itself, as a glint or through the wall:
 * the bound is white. Otherwise the layer only changes the light that the object sends onto objects
 * in the frame. */
static double bound_dn(const pl_view *view, part_fn part) {
  double radiance = 0.0;
  const double series = pl_view_series(view, view->max_bounces);
  pl_view_weigh(view, layer_light, &part);
  for (size_t i = 0; i < view->entity_count && radiance < view->white_radiance; i++) {
    const pl_view_entity *seen = &view->entities[i];
    if (!seen->in_frame)
      continue;
    if (part(seen) > 0.0)
      return pl_view_dn(view, view->white_radiance);
    radiance = fmax(radiance, pl_view_sum(view, seen, layer_light, &part) * series);
  }
  return pl_view_dn(view, radiance);
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 5e-5 * view->width * view->height * view->samples;
}

static const char *coat_absent(const pl_view *view) {
  return any(view, coat_of) ? NULL : "nothing in the scene has a clear coat";
}

static double coat_bound_dn(const pl_view *view, int value) {
  return value > 0 ? 0.0 : bound_dn(view, coat_of);
}

const pl_effect pl_effect_clear_coat = {
    .name = "clear_coat",
    .doc = "Clear coats on materials; off: the materials without them",
    .absent = coat_absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = coat_bound_dn,
    .cost_ms = cost_ms,
};

static const char *transmission_absent(const pl_view *view) {
  if (view->max_bounces == 0)
    return "max_bounces is 0";
  return any(view, passing) ? NULL : "nothing in the scene transmits light";
}

static double transmission_bound_dn(const pl_view *view, int value) {
  return value > 0 ? 0.0 : bound_dn(view, passing);
}

const pl_effect pl_effect_transmission = {
    .name = "transmission",
    .doc = "Light that passes through thin walls and solids; off: it is scattered back",
    .absent = transmission_absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = transmission_bound_dn,
    .cost_ms = cost_ms,
};
