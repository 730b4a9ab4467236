/* The stage `black_sun`: a CMOS pixel is read as the difference from its reset level, which is
 * sampled shortly after the reset. Charge gathered in between is lost. If that charge alone fills
 * the pixel, the difference is 0 and the sun appears black. */
#include <math.h>

#include "plan/effects.h"
#include "sensor/stages.h"

static void subtract_row(pl_sensor_frame *frame, int y) {
  const pl_sensor *sensor = frame->sensor;
  const double part = sensor->reset_s / sensor->exposure_s, well = sensor->full_well;
  const size_t first = (size_t)y * (size_t)frame->width;
  for (size_t i = first; i < first + (size_t)frame->width; i++) {
    const double charge = frame->electrons[i];
    frame->electrons[i] = fmax(0.0, fmin(charge, well) - fmin(charge * part, well));
  }
}

pl_status pl_stage_black_sun(pl_sensor_frame *frame, int value) {
  (void)value;
  return frame->sensor->exposure_s > 0.0 ? pl_sensor_rows(frame, subtract_row) : PL_OK;
}

static const char *absent(const pl_view *view) {
  const char *none = pl_sensor_absent(view);
  if (none != NULL)
    return none;
  const pl_sensor *s = view->sensor;
  return s->reset_s > 0.0 && s->exposure_s > 0.0
             ? NULL
             : "no time passes between reset and sample, or the exposure time is zero";
}

/* The largest charge that is lost. Blooming does not change its sources and fills other pixels at
 * most to the full well. */
static double bound_dn(const pl_view *view, int value) {
  const pl_sensor *s = view->sensor;
  if (value > 0)
    return 0.0;
  const double charge = pl_sensor_charge_max(view);
  return pl_sensor_dn(view, fmin(s->full_well, charge * s->reset_s / s->exposure_s));
}

static double cost_ms(const pl_view *view, int value) {
  return pl_sensor_cost_ms(view, 3.0 * value);
}

const pl_effect pl_effect_black_sun = {
    .name = "black_sun",
    .doc = "Sensor: charge collected before the reset sample is subtracted, so the sun is black",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
