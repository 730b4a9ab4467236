/* The effect row `volumes`: dust, gas and light within bounds. Its value is the number of steps
 * along a ray. */
#include "plan/effects.h"

#include <math.h>

/* A volume as an entry of the view, which may shadow and light objects and bodies. */
static pl_view_entity entity_of(const pl_view_volume *volume) {
  return (pl_view_entity){
      .distance_m = volume->distance_m,
      .radius_m = volume->radius_m,
      .center_m = {volume->center_m[0], volume->center_m[1], volume->center_m[2]},
  };
}

/* How a volume affects a frame. */
typedef struct influence {
  bool shades;   /* it blocks sunlight from objects, bodies or other media */
  double lights; /* maximum fraction of its radiance that an object or body in the frame reflects */
} influence;

/* Whether there are other media that a volume may shadow: other volumes, clouds, rings. */
static bool shades_media(const pl_view *view) {
  for (size_t i = 0; i < view->entity_count; i++)
    if (view->entities[i].clouds != NULL || view->entities[i].rings != NULL)
      return true;
  return view->volume_count > 1;
}

static influence influence_of(const pl_view *view, const pl_view_volume *volume) {
  const pl_view_entity entity = entity_of(volume);
  influence out = {.shades = false};
  for (size_t i = 0; i < view->entity_count; i++) {
    const pl_view_entity *other = &view->entities[i];
    if ((other->in_frame || view->max_bounces > 0) && volume->depth > 0.0 &&
        pl_view_shadow_reaches(view, &entity, other))
      out.shades = true;
    if (other->in_frame && view->max_bounces > 0)
      out.lights = fmax(out.lights,
                        pl_view_transfer(other, &entity) * pl_view_series(view, view->max_bounces));
  }
  out.shades = out.shades || (volume->depth > 0.0 && shades_media(view));
  return out;
}

/* Error without volumes: their light is missing, and nothing attenuates the light from behind them
 * or the sun's light. */
static double missing_dn(const pl_view *view) {
  double added = 0.0, depth = 0.0, sky_depth = 0.0;
  for (size_t i = 0; i < view->volume_count; i++) {
    const pl_view_volume *volume = &view->volumes[i];
    const influence s = influence_of(view, volume);
    added += (volume->in_frame ? 1.0 + s.lights : s.lights) * (volume->scattered + volume->emitted);
    depth += ((volume->in_frame ? 1.0 : 0.0) + (s.shades ? 1.0 : 0.0)) * volume->depth;
    sky_depth += volume->in_frame ? volume->depth : 0.0;
  }
  if (view->sun_in_frame && sky_depth > 0.0)
    return 255.0;
  return fmin(255.0, pl_view_dn(view, added) + pl_view_dn_dimming(-expm1(-depth)) +
                         pl_view_sky_dn(view, -expm1(-sky_depth) * pl_view_sky_max(view)));
}

static const char *absent(const pl_view *view) {
  if (view->volume_count == 0)
    return "there are no volumes";
  for (size_t i = 0; i < view->volume_count; i++) {
    const influence s = influence_of(view, &view->volumes[i]);
    if (view->volumes[i].in_frame || s.shades || s.lights > 0.0)
      return NULL;
  }
  return "no volume is visible, and none lights or shadows anything in the frame";
}

static int ceiling(const pl_view *view) { return view->volume_steps > 1 ? view->volume_steps : 1; }

/* With fewer steps than requested the error has no known bound, because a graph may define any
 * density. The bound without volumes is used. */
static double bound_dn(const pl_view *view, int value) {
  return value >= ceiling(view) ? 0.0 : missing_dn(view);
}

static double cost_ms(const pl_view *view, int value) {
  return 5e-4 * value * view->width * view->height;
}

const pl_effect pl_effect_volumes = {
    .name = "volumes",
    .doc = "Volumes that scatter sunlight, emit, attenuate the light behind them and cast "
           "shadows; the value is the number of steps along a ray",
    .absent = absent,
    .ceiling = ceiling,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
