/* The stage `fixed_pattern`: photo-response non-uniformity, the same in every frame (PRNU of EMVA
 * 1288). Each pixel has a factor 1 + prnu N(0, 1), never below 0, whose random key is the sensor's
 * serial number. */
#include <math.h>

#include "sensor/draws.h"
#include "plan/effects.h"
#include "sensor/stages.h"

static void scale_row(pl_sensor_frame *frame, int y) {
  const size_t first = (size_t)y * (size_t)frame->width;
  for (size_t i = first; i < first + (size_t)frame->width; i++) {
    pl_stream stream = pl_stream_of(frame->sensor->serial, PL_DRAW_PRNU, i, 0);
    frame->electrons[i] *= fmax(0.0, 1.0 + frame->sensor->prnu * pl_stream_normal(&stream));
  }
}

pl_status pl_stage_fixed_pattern(pl_sensor_frame *frame, int value) {
  (void)value;
  return pl_sensor_rows(frame, scale_row);
}

static const char *absent(const pl_view *view) {
  const char *none = pl_sensor_absent(view);
  return none != NULL ? none : view->sensor->prnu > 0.0 ? NULL : "all pixels respond equally";
}

static double bound_dn(const pl_view *view, int value) {
  return value > 0 ? 0.0 : pl_sensor_dimming_dn(view, PL_SENSOR_SIGMAS * view->sensor->prnu);
}

static double cost_ms(const pl_view *view, int value) {
  return pl_sensor_cost_ms(view, 60.0 * value);
}

const pl_effect pl_effect_fixed_pattern = {
    .name = "fixed_pattern",
    .doc = "Sensor: pixel response non-uniformity, the same in every frame",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
