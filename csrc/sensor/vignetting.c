/* The stage `vignetting`: light decreases away from the axis; see shading.h. */
#include <math.h>

#include "plan/effects.h"
#include "sensor/stages.h"

static void dim_row(pl_sensor_frame *frame, int y) {
  const pl_shading *shading = &frame->sensor->shading;
  pl_vec3f *row = frame->bands + (size_t)y * (size_t)frame->width;
  double tangent[2], place[2] = {0.0, (y + 0.5) / frame->height};
  tangent[1] = (y - frame->centre_px[1]) / frame->focal_px[1];
  for (int x = 0; x < frame->width; x++) {
    tangent[0] = (x - frame->centre_px[0]) / frame->focal_px[0];
    place[0] = (x + 0.5) / frame->width;
    const float factor = (float)pl_shading_at(shading, tangent, place);
    row[x] = (pl_vec3f){factor * row[x].x, factor * row[x].y, factor * row[x].z};
  }
}

pl_status pl_stage_vignetting(pl_sensor_frame *frame, int value) {
  (void)value;
  return pl_sensor_rows(frame, dim_row);
}

static const char *absent(const pl_view *view) {
  const char *none = pl_sensor_absent(view);
  if (none != NULL)
    return none;
  const pl_shading *s = &view->sensor->shading;
  return s->power > 0.0 || s->count > 0 || s->flat != NULL ? NULL : "no vignetting";
}

/* Assumes the darkest corner everywhere. Brightening by a flat field's factor counts as dimming by
 * its inverse. */
static double bound_dn(const pl_view *view, int value) {
  double low, high;
  pl_shading_range(&view->sensor->shading, view->corner_tangent, &low, &high);
  return value > 0 ? 0.0 : pl_sensor_dimming_dn(view, fmax(1.0 - low, 1.0 - 1.0 / fmax(high, 1.0)));
}

static double cost_ms(const pl_view *view, int value) {
  return pl_sensor_cost_ms(view, 30.0 * value);
}

const pl_effect pl_effect_vignetting = {
    .name = "vignetting",
    .doc = "Sensor: light falls off with the angle to the optical axis",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
