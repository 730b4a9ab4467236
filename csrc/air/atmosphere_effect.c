/* The effect row `atmosphere`: light scattered and absorbed by air. Its value is the number of
 * steps of the integral along a ray. */
#include "plan/effects.h"

#include <math.h>

#include "air/light_bounds.h"

static const char *absent(const pl_view *view) {
  bool any = false;
  for (size_t i = 0; i < view->entity_count; i++) {
    if (pl_air_fraction(view, &view->entities[i]) > 0.0)
      return NULL;
    any |= view->entities[i].air != NULL;
  }
  return any ? "no atmosphere is visible, and none lights anything in the frame"
             : "no body has an atmosphere";
}

static int ceiling(const pl_view *view) {
  (void)view;
  return 32;
}

/* At x, relative to white, the slope of the encoding is at most SLOPE x^-PL_AIR_POWER, and never
 * more than that at KNEE. */
static const double SLOPE = 255.0 * 1.055 / 2.4, KNEE = 0.003;

static double residual_dn(const pl_view *view, const pl_view_entity *body, int steps,
                          double fraction) {
  const pl_air_light_bounds bounds = pl_air_light_bounds_of(body->air);
  const double bright = fraction * body->irradiance / view->white_radiance;
  const double long_exposure = pow(fmax(1.0, bright * PL_AIR_DARK / KNEE), PL_AIR_POWER);
  const double error = pl_air_step_error(&bounds, steps) * long_exposure;
  return fmin(SLOPE * pow(bright, 1.0 - PL_AIR_POWER) * error,
              pl_view_dn(view, fraction * body->irradiance * (bounds.scattered + bounds.several)));
}

/* Upper bound if the atmosphere is left out altogether: scattered light is missing, and so is the
 * attenuation on the way from the sun and to the camera. The sun's disc itself may be attenuated.
 */
static double missing_dn(const pl_view *view, const pl_view_entity *body, double fraction) {
  const pl_air_light_bounds bounds = pl_air_light_bounds_of(body->air);
  const double dimmed = -expm1(-2.0 * bounds.depth);
  if (view->sun_in_frame && body->air_in_frame)
    return pl_view_dn(view, INFINITY) * (dimmed > 0.0);
  const double added = fraction * body->irradiance *
                       (bounds.scattered + bounds.several + bounds.sky / 3.14159265358979);
  const double gone = pl_view_dn_dimming(dimmed);
  const double sky = pl_view_sky_dn(view, pl_view_sky_max(view)); /* stars are attenuated too */
  return fmin(255.0, pl_view_dn(view, added) +
                         (fraction < 1.0
                              ? fmin(gone, pl_view_dn(view, fraction * pl_view_light(body)) + sky)
                              : gone));
}

static double bound_dn(const pl_view *view, int value) {
  double sum = 0.0;
  for (size_t i = 0; i < view->entity_count; i++) {
    const double fraction = pl_air_fraction(view, &view->entities[i]);
    if (fraction > 0.0)
      sum += value > 0 ? residual_dn(view, &view->entities[i], value, fraction)
                       : missing_dn(view, &view->entities[i], fraction);
  }
  return fmin(sum, 255.0);
}

static double cost_ms(const pl_view *view, int value) {
  return 3e-5 * value * view->width * view->height;
}

const pl_effect pl_effect_atmosphere = {
    .name = "atmosphere",
    .doc = "Air of bodies that scatters sunlight and attenuates light that passes through it; "
           "the value is the number of steps along a ray",
    .absent = absent,
    .ceiling = ceiling,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
