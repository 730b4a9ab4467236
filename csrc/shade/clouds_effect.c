/* The effect row `clouds`: shells of clouds of bodies, by the number of octaves of their noise. */
#include <math.h>

#include "shade/clouds.h"
#include "plan/effects.h"

/* Weight of a body's clouds in a frame: 1 if they are visible, less if they only scatter light onto
 * objects in the frame or shade them, 0 for neither. */
static double fraction_of(const pl_view *view, const pl_view_entity *body) {
  if (body->clouds == NULL)
    return 0.0;
  if (body->clouds_in_frame)
    return 1.0;
  return pl_view_shell_fraction(view, body, body->radius_m + body->clouds->altitude_m);
}

static const char *absent(const pl_view *view) {
  bool any = false;
  for (size_t i = 0; i < view->entity_count; i++) {
    if (fraction_of(view, &view->entities[i]) > 0.0)
      return NULL;
    any |= view->entities[i].clouds != NULL;
  }
  return any ? "no clouds are visible, and none light or shadow anything in the frame"
             : "no body has clouds";
}

static int ceiling(const pl_view *view) {
  double octaves = 1.0;
  for (size_t i = 0; i < view->entity_count; i++)
    if (view->entities[i].clouds != NULL && pl_clouds_noisy(view->entities[i].clouds))
      octaves = fmax(octaves, ceil((double)view->entities[i].clouds->octaves));
  return (int)octaves;
}

/* Minimum width of a sample's footprint on the shell, at its nearest point. */
static double footprint_m(const pl_view *view, const pl_view_entity *body) {
  const double shell_m = body->radius_m + body->clouds->altitude_m;
  const double far = fmax(0.0, body->distance_m - shell_m);
  return far * view->pixel_rad / sqrt(fmax(1.0, (double)view->samples)) /
         (1.0 + view->corner_tangent * view->corner_tangent);
}

/* Upper bound of the factor by which tops tilted towards the sun are brighter than level ones
 * (render/cloud_medium.c). */
static const double TILTED = 1.8;

/* Bound of the change of a pixel if the cover changes by `cover`: the brightest possible cloud is
 * added, or the same part of the background is removed, once along the sun's light and twice along
 * the ray. */
static double changed_dn(const pl_view *view, const pl_view_entity *body, double cover,
                         double fraction) {
  const double tilted = body->clouds->relief_m > 0.0f ? TILTED : 1.0;
  const double bright = fraction * cover * tilted * pl_view_light(body);
  const double dimmed = pl_view_dn_dimming(fmin(1.0, 3.0 * cover));
  const double sky = pl_view_sky_dn(view, cover * pl_view_sky_max(view));
  if (fraction < 1.0)
    return pl_view_dn(view, 3.0 * bright) + sky;
  return pl_view_dn(view, 2.0 * bright) + dimmed + sky;
}

static double bound_dn(const pl_view *view, int value) {
  double sum = 0.0;
  for (size_t i = 0; i < view->entity_count; i++) {
    const pl_view_entity *body = &view->entities[i];
    const double fraction = fraction_of(view, body);
    if (!(fraction > 0.0))
      continue;
    double error =
        value == 0 ? 1.0 : pl_clouds_detail_error(body->clouds, value, footprint_m(view, body));
    if (error > 0.0 && pl_clouds_uneven(body->clouds))
      error = 1.0; /* there is no such bound for depths and slopes */
    const double cover = (double)body->clouds->opacity * error;
    if (cover > 0.0)
      sum += changed_dn(view, body, cover, fraction);
  }
  return fmin(sum, 255.0);
}

static double cost_ms(const pl_view *view, int value) {
  return (2e-3 + 2e-4 * value) * view->width * view->height;
}

const pl_effect pl_effect_clouds = {
    .name = "clouds",
    .doc = "Clouds that scatter sunlight, shadow the ground and hide what is behind them; the "
           "value is the number of octaves of their noise",
    .absent = absent,
    .ceiling = ceiling,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
