#include "plan/changed_surfaces.h"

#include <math.h>

#include "plan/view_tree.h"

bool pl_view_has(const pl_view *view, pl_view_picks picks) {
  for (size_t i = 0; i < view->entity_count; i++)
    if (picks(&view->entities[i], 0))
      return true;
  return false;
}

typedef struct change {
  pl_view_picks picks;
  int value;
} change;

static double picked_light(const pl_view_entity *source, const void *context) {
  const change *change = context;
  return change->picks(source, change->value) ? pl_view_light(source) : 0.0;
}

/* Upper bound of the indirect light that picked entities send onto entities[i]. */
static double indirect(const pl_view *view, const change *change, size_t i) {
  return pl_view_sum(view, &view->entities[i], picked_light, change) *
         pl_view_series(view, view->max_bounces);
}

/* Upper bound of the change of an entity's own radiance: a diffuse surface can gain or lose all
 * light that it receives, a glossy one can reflect the sun to the camera. */
static double own(const pl_view *view, size_t i) {
  const pl_view_entity *entity = &view->entities[i];
  if (!entity->diffuse)
    return view->white_radiance;
  const double direct = entity->albedo_max * entity->irradiance / 3.14159265358979;
  return (direct + entity->emission_max + pl_view_received(view, i)) *
         pl_view_series(view, view->max_bounces + 1);
}

double pl_view_changed_dn(const pl_view *view, pl_view_picks picks, int value) {
  const change change = {picks, value};
  double radiance = 0.0;
  pl_view_weigh(view, picked_light, &change);
  for (size_t i = 0; i < view->entity_count && radiance < view->white_radiance; i++)
    if (view->entities[i].in_frame)
      radiance = fmax(radiance, indirect(view, &change, i) +
                                    (picks(&view->entities[i], value) ? own(view, i) : 0.0));
  return pl_view_dn(view, radiance);
}
