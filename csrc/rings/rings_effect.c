/* The effect row `rings`: light that rings add, what they hide and the shadows that they cast. */
#include "plan/effects.h"

#include <math.h>
#include <stddef.h>

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Upper bound of the path length through the rings relative to the path along their normal, for
 * lines from the rings to points within margin_m of `point_m`. No point of the rings is farther
 * from that point than the point's distance from the centre plus the ring radius. */
static double longest(const pl_view_entity *body, const double point_m[3], double margin_m) {
  const double from[3] = {point_m[0] - body->center_m[0], point_m[1] - body->center_m[1],
                          point_m[2] - body->center_m[2]};
  const double height = fabs(dot(body->rings->axis, from)) - margin_m;
  const double far = sqrt(dot(from, from)) + margin_m + body->rings->radius_m;
  return height > 0.0 ? far / height : INFINITY;
}

static double opacity(const pl_view_entity *body, double path) {
  return body->rings->depth > 0.0 ? -expm1(-body->rings->depth * path) : 0.0;
}

/* True if sunlight crosses the rings on its way to an object or body in the frame. */
static bool shades(const pl_view *view, const pl_view_entity *body) {
  const pl_view_entity shell = pl_view_ring_sphere(body);
  for (size_t i = 0; i < view->entity_count; i++)
    if (view->entities[i].in_frame && pl_view_shadow_reaches(view, &shell, &view->entities[i]))
      return true;
  return false;
}

/* Upper bound of the fraction of a source's light that rings block from a receiver. A line at an
 * angle to the ring plane whose sine is y loses min(1, depth/y) at most. Over a disc of angular
 * radius rho centred on the plane's horizon, the mean of this loss is below (4/pi) depth/rho (1 +
 * ln(rho/depth)). The bound is twice that, to include angles too large for the small-angle
 * approximation. A mirror may reflect only the horizon, so its bound is 1. */
static double kept_back(double depth, const pl_view_entity *receiver,
                        const pl_view_entity *source) {
  double d2 = 0.0;
  for (int k = 0; k < 3; k++)
    d2 += pow(receiver->center_m[k] - source->center_m[k], 2.0);
  const double rho = source->radius_m / (sqrt(d2) + receiver->radius_m + source->radius_m);
  if (!(depth > 0.0) || receiver->ggx_alpha_min < 1.0)
    return depth > 0.0;
  return fmin(1.0, 2.55 * depth / rho * (1.0 + log1p(rho / depth)));
}

/* Upper bound of the radiance that objects and bodies in the frame reflect of the rings' light, or
 * lose of the light from others. Light that a body receives from its own rings is neglected at
 * every value of the effect. `lit`: relative path length of sunlight through the rings. */
static double reflected(const pl_view *view, const pl_view_entity *body, double lit) {
  const pl_view_entity shell = pl_view_ring_sphere(body);
  double most = 0.0;
  for (size_t i = 0; i < view->entity_count; i++) {
    const pl_view_entity *entity = &view->entities[i];
    if (!entity->in_frame)
      continue;
    double sum = 0.0;
    if (entity != body)
      sum = pl_view_transfer(entity, &shell) * body->rings->light *
            fmin(1.0, kept_back(body->rings->depth, entity, &shell) + body->rings->depth * lit);
    for (size_t k = 0; k < view->entity_count; k++)
      if (k != i)
        sum += pl_view_transfer(entity, &view->entities[k]) * pl_view_light(&view->entities[k]) *
               kept_back(body->rings->depth, entity, &view->entities[k]);
    most = fmax(most, sum);
  }
  return most * pl_view_series(view, view->max_bounces);
}

static const char *absent(const pl_view *view) {
  bool any = false;
  for (size_t i = 0; i < view->entity_count; i++) {
    const pl_view_entity *entity = &view->entities[i];
    if (entity->rings == NULL)
      continue;
    if (entity->rings->in_frame || shades(view, entity) || reflected(view, entity, INFINITY) > 0.0)
      return NULL;
    any = true;
  }
  return any ? "no rings are visible or cast shadows in the frame" : "no body has rings";
}

static double missing_dn(const pl_view *view, const pl_view_entity *body) {
  static const double camera[3] = {0.0, 0.0, 0.0};
  const double seen = longest(body, camera, 0.0);
  const double lit = longest(body, view->sun_position_m, view->sun_radius_m);
  double sum = pl_view_dn(view, reflected(view, body, lit));
  if (shades(view, body))
    sum += pl_view_dn_dimming(opacity(body, lit));
  if (!body->rings->in_frame)
    return sum;
  const double hidden = opacity(body, seen);
  if (view->sun_in_frame && hidden > 0.0)
    return pl_view_dn(view, INFINITY);
  /* Single scattering returns at most the optical depth along both paths. */
  const double scattered =
      body->rings->depth > 0.0 ? fmin(1.0, body->rings->depth * (seen + lit)) : 0.0;
  return sum + pl_view_dn(view, scattered * body->rings->light) + pl_view_dn_dimming(hidden) +
         pl_view_sky_dn(view, hidden * pl_view_sky_max(view));
}

static double bound_dn(const pl_view *view, int value) {
  double sum = 0.0;
  for (size_t i = 0; value == 0 && i < view->entity_count; i++)
    if (view->entities[i].rings != NULL)
      sum += missing_dn(view, &view->entities[i]);
  return fmin(sum, 255.0);
}

static double cost_ms(const pl_view *view, int value) {
  return 3e-5 * value * view->width * view->height * view->samples;
}

const pl_effect pl_effect_rings = {
    .name = "rings",
    .doc = "Rings of bodies: single scattering of sunlight, attenuation of what is behind them, "
           "and shadows",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
