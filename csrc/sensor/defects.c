/* The stage `defects`: hot pixels, with a dark current far above that of the others, and dead
 * pixels, which do not respond. The random key of their positions is the sensor's serial number. */
#include "sensor/draws.h"
#include "plan/effects.h"
#include "sensor/stages.h"

static void spoil_row(pl_sensor_frame *frame, int y) {
  const pl_sensor *sensor = frame->sensor;
  const size_t first = (size_t)y * (size_t)frame->width;
  for (size_t i = first; i < first + (size_t)frame->width; i++) {
    pl_stream stream = pl_stream_of(sensor->serial, PL_DRAW_DEFECT, i, 0);
    const double u = pl_stream_uniform(&stream);
    if (u < sensor->dead_pixels)
      frame->electrons[i] = 0.0;
    else if (u < sensor->dead_pixels + sensor->hot_pixels) /* 0.5 to 1.5 times hot_current */
      frame->electrons[i] +=
          sensor->hot_current * sensor->exposure_s * (0.5 + pl_stream_uniform(&stream));
  }
}

pl_status pl_stage_defects(pl_sensor_frame *frame, int value) {
  (void)value;
  return pl_sensor_rows(frame, spoil_row);
}

static const char *absent(const pl_view *view) {
  const char *none = pl_sensor_absent(view);
  if (none != NULL)
    return none;
  return view->sensor->hot_pixels + view->sensor->dead_pixels > 0.0 ? NULL
                                                                    : "no pixel is defective";
}

static double bound_dn(const pl_view *view, int value) {
  const pl_sensor *sensor = view->sensor;
  if (value > 0)
    return 0.0;
  if (sensor->dead_pixels > 0.0)
    return pl_sensor_dn(view, pl_sensor_white_electrons(sensor));
  return pl_sensor_dn(view, 1.5 * sensor->hot_current * sensor->exposure_s);
}

static double cost_ms(const pl_view *view, int value) {
  return pl_sensor_cost_ms(view, 30.0 * value);
}

const pl_effect pl_effect_defects = {
    .name = "defects",
    .doc = "Sensor: hot and dead pixels",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
