/* The effect row `surface_maps`: textures and maps instead of their means. */
#include "plan/effects.h"
#include "plan/view_tree.h"

#include <math.h>
#include <stddef.h>

static const char *absent(const pl_view *view) {
  for (size_t i = 0; i < view->entity_count; i++)
    if (view->entities[i].textured)
      return NULL;
  return "nothing in the scene has a map";
}

/* Bound of the change of an object in the frame: up to the brightest diffuse radiance. On a mesh or
 * in a graph, a roughness map can turn a rough surface into a mirror that shows the sun, an
 * emission map can turn a dark one into a light source. */
static double own_radiance(const pl_view *view, const pl_view_entity *entity) {
  const double diffuse = entity->albedo_max * entity->irradiance / 3.14159265358979;
  return entity->is_body && !entity->graphed && !entity->ocean
             ? diffuse + entity->lights_max
             : fmax(diffuse, view->white_radiance);
}

/* Otherwise a map acts through the light that its object reflects or emits onto objects in the
 * frame. */
static double mapped_light(const pl_view_entity *source, const void *context) {
  (void)context;
  return source->textured ? pl_view_light(source) : 0.0;
}

static double bound_dn(const pl_view *view, int value) {
  double radiance = 0.0;
  if (value > 0)
    return 0.0;
  const double series = pl_view_series(view, view->max_bounces);
  pl_view_weigh(view, mapped_light, NULL);
  for (size_t i = 0; i < view->entity_count && radiance < view->white_radiance; i++) {
    const pl_view_entity *entity = &view->entities[i];
    if (!entity->in_frame)
      continue;
    if (entity->textured)
      radiance = fmax(radiance, own_radiance(view, entity));
    radiance = fmax(radiance, pl_view_sum(view, entity, mapped_light, NULL) * series);
  }
  return pl_view_dn(view, radiance);
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 5e-5 * view->width * view->height * view->samples;
}

const pl_effect pl_effect_surface_maps = {
    .name = "surface_maps",
    .doc = "Colour, roughness, normal and emission maps, mottling, grain of rocks; off: means",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
