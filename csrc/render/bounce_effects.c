/* The effect rows `bounces` and `body_bounces`: light that arrives by way of other surfaces. */
#include "render/effects.h"

#include <math.h>
#include <stddef.h>

static const char *absent(const pl_view *view) {
  if (view->max_bounces == 0)
    return "max_bounces is 0";
  for (size_t i = 0; i < view->thing_count; i++)
    if (view->things[i].in_frame && !view->things[i].is_body)
      return NULL;
  return "no mesh is in the frame";
}

static int ceiling(const pl_view *view) { return view->max_bounces > 0 ? view->max_bounces : 1; }

/* What paths of more than `value` bounces can add: each bounce keeps at most the largest albedo,
 * a geometric series. Glossy surfaces may show the sun itself, hence the display's white. */
static double bound_dn(const pl_view *view, int value) {
  double albedo = 0.0, radiance = 0.0;
  for (size_t i = 0; i < view->thing_count; i++) {
    const pl_view_thing *thing = &view->things[i];
    albedo = fmax(albedo, thing->albedo_max);
    radiance = fmax(radiance, thing->albedo_max * thing->irradiance / 3.14159265358979);
  }
  if (albedo >= 1.0)
    return pl_view_dn(view, view->white_radiance);
  return pl_view_dn(view, radiance * pow(albedo, value + 1) / (1.0 - albedo));
}

static double cost_ms(const pl_view *view, int value) {
  return 1.5e-4 * view->width * view->height * view->samples * value;
}

const pl_effect pl_effect_bounces = {
    .name = "bounces",
    .doc = "Light reflected between surfaces, counted in bounces, as seen on meshes",
    .absent = absent,
    .ceiling = ceiling,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};

static const char *body_absent(const pl_view *view) {
  if (view->max_bounces == 0)
    return "max_bounces is 0";
  for (size_t i = 0; i < view->thing_count; i++)
    if (view->things[i].in_frame && view->things[i].is_body && view->thing_count > 1)
      return NULL;
  return "no body in the frame has anything in its sky";
}

/* Light that a source reflects onto a Lambert body, by the source's view factor. */
static double body_bound_dn(const pl_view *view, int value) {
  if (value > 0)
    return 0.0;
  double radiance = 0.0;
  for (size_t i = 0; i < view->thing_count; i++) {
    const pl_view_thing *receiver = &view->things[i];
    if (!receiver->in_frame || !receiver->is_body)
      continue;
    double sum = 0.0;
    for (size_t k = 0; k < view->thing_count; k++)
      if (k != i)
        sum += view->things[k].albedo_max * view->things[k].irradiance *
               pl_view_factor(receiver, &view->things[k]);
    radiance = fmax(radiance, receiver->albedo_max * sum / 3.14159265358979);
  }
  return pl_view_dn(view, radiance);
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
