/* The stage `dark_current`: thermally generated electrons, with dark-signal non-uniformity. The
 * ratio of a pixel's dark current to the mean is log-normal with the stated relative deviation
 * (warm pixels form its long tail), and its random key is the sensor's serial number. The stage
 * `shot_noise` adds the noise. */
#include <math.h>

#include "sensor/draws.h"
#include "plan/effects.h"
#include "sensor/stages.h"

static void add_row(pl_sensor_frame *frame, int y) {
  const pl_sensor *sensor = frame->sensor;
  const double mean = sensor->dark_current * sensor->exposure_s;
  /* exp(s N - s^2/2) has the mean 1 and the variance exp(s^2) - 1 */
  const double square = log1p(sensor->dark_nonuniform * sensor->dark_nonuniform);
  const size_t first = (size_t)y * (size_t)frame->width;
  for (size_t i = first; i < first + (size_t)frame->width; i++) {
    double factor = 1.0;
    if (square > 0.0) {
      pl_stream stream = pl_stream_of(sensor->serial, PL_DRAW_DARK, i, 0);
      factor = exp(sqrt(square) * pl_stream_normal(&stream) - 0.5 * square);
    }
    frame->electrons[i] += mean * factor;
  }
}

pl_status pl_stage_dark_current(pl_sensor_frame *frame, int value) {
  (void)value;
  return pl_sensor_rows(frame, add_row);
}

static const char *absent(const pl_view *view) {
  const char *none = pl_sensor_absent(view);
  if (none != NULL)
    return none;
  return view->sensor->dark_current * view->sensor->exposure_s > 0.0 ? NULL : "no dark current";
}

double pl_sensor_dark_max(const pl_sensor *sensor) {
  const double square = log1p(sensor->dark_nonuniform * sensor->dark_nonuniform);
  const double most = exp(PL_SENSOR_SIGMAS * sqrt(square) - 0.5 * square);
  return most * sensor->dark_current * sensor->exposure_s;
}

static double bound_dn(const pl_view *view, int value) {
  return value > 0 ? 0.0 : pl_sensor_dn(view, pl_poisson_most(pl_sensor_dark_max(view->sensor)));
}

static double cost_ms(const pl_view *view, int value) {
  return pl_sensor_cost_ms(view, 80.0 * value);
}

const pl_effect pl_effect_dark_current = {
    .name = "dark_current",
    .doc = "Sensor: thermally generated electrons, with non-uniformity",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
