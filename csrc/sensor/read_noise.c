/* The stage `read_noise`: normal noise of the amplifier, new in each frame, and an offset of each
 * column that stays. */
#include "sensor/draws.h"
#include "sensor/effects.h"
#include "sensor/stages.h"

static void add_row(pl_sensor_frame *frame, int y) {
  const pl_sensor *sensor = frame->sensor;
  const size_t width = (size_t)frame->width, first = (size_t)y * width;
  for (size_t x = 0; x < width; x++) {
    pl_stream stream = pl_stream_of(frame->seed, PL_DRAW_READ, first + x, frame->index);
    frame->electrons[first + x] += sensor->read_noise * pl_stream_normal(&stream);
    if (sensor->column_noise > 0.0) {
      pl_stream column = pl_stream_of(sensor->serial, PL_DRAW_COLUMN, x, 0);
      frame->electrons[first + x] += sensor->column_noise * pl_stream_normal(&column);
    }
  }
}

pl_status pl_stage_read_noise(pl_sensor_frame *frame, int value) {
  (void)value;
  return pl_sensor_rows(frame, add_row);
}

static const char *absent(const pl_view *view) {
  const char *none = pl_sensor_absent(view);
  if (none != NULL)
    return none;
  return view->sensor->read_noise + view->sensor->column_noise > 0.0 ? NULL : "no read noise";
}

static double bound_dn(const pl_view *view, int value) {
  const double sigmas = PL_SENSOR_SIGMAS * (view->sensor->read_noise + view->sensor->column_noise);
  return value > 0 ? 0.0 : pl_sensor_dn(view, sigmas);
}

static double cost_ms(const pl_view *view, int value) {
  return pl_sensor_cost_ms(view, 60.0 * value);
}

const pl_effect pl_effect_read_noise = {
    .name = "read_noise",
    .doc = "Sensor: noise of reading out, and columns with offsets of their own",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
