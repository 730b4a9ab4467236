/* The stage `read_noise`: Gaussian amplifier noise and row and column offsets that change in each
 * frame, and a fixed offset of each column. */
#include "sensor/draws.h"
#include "plan/effects.h"
#include "sensor/stages.h"

/* A random offset of the frame or, with `fixed`, of the sensor unit. No random number is used for a
 * deviation of 0. */
static double offset(const pl_sensor_frame *frame, double deviation, pl_draw what, bool fixed,
                     uint64_t item) {
  if (!(deviation > 0.0))
    return 0.0;
  pl_stream stream = pl_stream_of(fixed ? frame->sensor->serial : frame->seed, what, item,
                                  fixed ? 0 : frame->index);
  return deviation * pl_stream_normal(&stream);
}

static void add_row(pl_sensor_frame *frame, int y) {
  const pl_sensor *sensor = frame->sensor;
  const size_t width = (size_t)frame->width, first = (size_t)y * width;
  const double row = offset(frame, sensor->row_noise, PL_DRAW_ROW, false, (uint64_t)y);
  for (size_t x = 0; x < width; x++) {
    double *pixel = &frame->electrons[first + x];
    *pixel += offset(frame, sensor->read_noise, PL_DRAW_READ, false, first + x);
    *pixel += offset(frame, sensor->column_noise, PL_DRAW_COLUMN, true, x);
    *pixel += offset(frame, sensor->column_flicker, PL_DRAW_FLICKER, false, x) + row;
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
  return pl_sensor_read_deviation(view->sensor) > 0.0 ? NULL : "no read noise";
}

static double bound_dn(const pl_view *view, int value) {
  const double sigmas = PL_SENSOR_SIGMAS * pl_sensor_read_deviation(view->sensor);
  return value > 0 ? 0.0 : pl_sensor_dn(view, sigmas);
}

static double cost_ms(const pl_view *view, int value) {
  return pl_sensor_cost_ms(view, 60.0 * value);
}

const pl_effect pl_effect_read_noise = {
    .name = "read_noise",
    .doc = "Sensor: noise of the readout, and offsets of rows and columns",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
