/* The effect rows `glint` and `night_lights`: open water and lights at night on bodies. */
#include <math.h>

#include "plan/effects.h"
#include "plan/view_tree.h"

/* Light of an object with the feature; 0 without it. */
typedef double (*light_fn)(const pl_view_entity *entity);

static double part_light(const pl_view_entity *source, const void *context) {
  const light_fn *light = context;
  return (*light)(source);
}

/* Upper bound of the indirect light onto entities[i]; call pl_view_weigh before. */
static double indirect(const pl_view *view, size_t i, light_fn light) {
  return pl_view_sum(view, &view->entities[i], part_light, &light) *
         pl_view_series(view, view->max_bounces);
}

static bool any(const pl_view *view, light_fn light) {
  for (size_t i = 0; i < view->entity_count; i++)
    if (light(&view->entities[i]) > 0.0)
      return true;
  return false;
}

static double cost_ms(const pl_view *view, int value) {
  (void)value;
  return 3e-5 * view->width * view->height * view->samples;
}

static double water_light(const pl_view_entity *entity) {
  return entity->ocean ? pl_view_light(entity) : 0.0;
}

static const char *glint_absent(const pl_view *view) {
  for (size_t i = 0; i < view->entity_count; i++)
    if (view->entities[i].ocean)
      return NULL;
  return "no body in the scene has open water";
}

/* Bound: sunlight reflected by the sharpest lobe, plus all other light that the water, or the
 * ground in its place, receives and reflects. */
static double glint_bound_dn(const pl_view *view, int value) {
  const light_fn light = water_light;
  double radiance = 0.0;
  pl_view_weigh(view, part_light, &light);
  for (size_t i = 0; value == 0 && i < view->entity_count && radiance < view->white_radiance; i++) {
    const pl_view_entity *entity = &view->entities[i];
    if (!entity->in_frame)
      continue;
    const double lobe = 0.5 / pow(entity->ggx_alpha_min, 3.0) + 1.0;
    const double own = entity->irradiance / 3.14159265358979 * lobe +
                       pl_view_received(view, i) * pl_view_series(view, view->max_bounces);
    radiance = fmax(radiance, indirect(view, i, water_light) + (entity->ocean ? own : 0.0));
  }
  return pl_view_dn(view, radiance);
}

const pl_effect pl_effect_glint = {
    .name = "glint",
    .doc = "Sun glint on the waves of open water; off: the colour map alone",
    .absent = glint_absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = glint_bound_dn,
    .cost_ms = cost_ms,
};

static double lights_of(const pl_view_entity *entity) { return entity->lights_max; }

static const char *lights_absent(const pl_view *view) {
  return any(view, lights_of) ? NULL : "no body in the scene has night lights";
}

static double lights_bound_dn(const pl_view *view, int value) {
  const light_fn light = lights_of;
  double radiance = 0.0;
  pl_view_weigh(view, part_light, &light);
  for (size_t i = 0; value == 0 && i < view->entity_count && radiance < view->white_radiance; i++)
    if (view->entities[i].in_frame)
      radiance = fmax(radiance, indirect(view, i, lights_of) + view->entities[i].lights_max);
  return pl_view_dn(view, radiance);
}

const pl_effect pl_effect_night_lights = {
    .name = "night_lights",
    .doc = "Night lights on bodies, where the sun is down; off: dark",
    .absent = lights_absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = lights_bound_dn,
    .cost_ms = cost_ms,
};
