/* The stage `smear`: a frame-transfer CCD without a shutter stays exposed while its columns shift.
 * Each pixel receives the sum of its column times the ratio of the time of one row shift to the
 * exposure time. */
#include <math.h>

#include "plan/effects.h"
#include "sensor/stages.h"

static void smear_column(pl_sensor_frame *frame, int x) {
  const size_t width = (size_t)frame->width, rows = (size_t)frame->height;
  const double part = frame->sensor->shift_s / frame->sensor->exposure_s;
  double sum = 0.0;
  for (size_t y = 0; y < rows; y++)
    sum += frame->electrons[y * width + (size_t)x];
  for (size_t y = 0; y < rows; y++)
    frame->electrons[y * width + (size_t)x] += part * sum;
}

pl_status pl_stage_smear(pl_sensor_frame *frame, int value) {
  (void)value;
  /* without exposure there is no charge to smear */
  return frame->sensor->exposure_s > 0.0 ? pl_sensor_columns(frame, smear_column) : PL_OK;
}

static const char *absent(const pl_view *view) {
  const char *none = pl_sensor_absent(view);
  if (none != NULL)
    return none;
  const pl_sensor *sensor = view->sensor;
  return sensor->shift_s > 0.0 && sensor->exposure_s > 0.0
             ? NULL
             : "the shift takes no time, or the exposure time is zero";
}

static double bound_dn(const pl_view *view, int value) {
  const pl_sensor *sensor = view->sensor;
  const double part = view->height * sensor->shift_s / sensor->exposure_s;
  return value > 0 ? 0.0 : pl_sensor_dn(view, part * pl_sensor_light_max(view));
}

static double cost_ms(const pl_view *view, int value) {
  return pl_sensor_cost_ms(view, 10.0 * value);
}

const pl_effect pl_effect_smear = {
    .name = "smear",
    .doc = "Sensor: light that columns collect while they are shifted out",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
