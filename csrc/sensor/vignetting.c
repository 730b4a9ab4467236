/* The stage `vignetting`: less light off the axis: cos^4 of the angle (natural), scaled by the
 * stated exponent: cos^n; n = 4 is the law of a thin lens, 0 none. */
#include <math.h>

#include "sensor/effects.h"
#include "sensor/stages.h"

static void dim_row(pl_sensor_frame *frame, int y) {
  const double v = (y - frame->centre_px[1]) / frame->focal_px[1];
  const double half = -0.5 * frame->sensor->vignetting;
  pl_vec3f *row = frame->bands + (size_t)y * (size_t)frame->width;
  for (int x = 0; x < frame->width; x++) {
    const double u = (x - frame->centre_px[0]) / frame->focal_px[0];
    const float factor = (float)pow(1.0 + u * u + v * v, half); /* cos^2 = 1 / (1 + tan^2) */
    row[x] = (pl_vec3f){factor * row[x].x, factor * row[x].y, factor * row[x].z};
  }
}

pl_status pl_stage_vignetting(pl_sensor_frame *frame, int value) {
  (void)value;
  return pl_sensor_rows(frame, dim_row);
}

static const char *absent(const pl_view *view) {
  const char *none = pl_sensor_absent(view);
  return none != NULL ? none : view->sensor->vignetting > 0.0 ? NULL : "no vignetting";
}

/* Everywhere as in a corner whose axis is at the opposite one, twice as far as in the middle. */
static double bound_dn(const pl_view *view, int value) {
  const double reach = hypot(view->width, view->height) * tan(view->pixel_rad);
  const double cosine = 1.0 / sqrt(1.0 + reach * reach);
  return value > 0 ? 0.0 : pl_view_dn_dimming(1.0 - pow(cosine, view->sensor->vignetting));
}

static double cost_ms(const pl_view *view, int value) {
  return pl_sensor_cost_ms(view, 30.0 * value);
}

const pl_effect pl_effect_vignetting = {
    .name = "vignetting",
    .doc = "Sensor: light falls off with the angle to the axis",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
