/* The stage `shot_noise`: electron counts are integers with a Poisson distribution. */
#include <math.h>

#include "sensor/draws.h"
#include "plan/effects.h"
#include "sensor/stages.h"

static void count_row(pl_sensor_frame *frame, int y) {
  const size_t first = (size_t)y * (size_t)frame->width;
  for (size_t i = first; i < first + (size_t)frame->width; i++) {
    pl_stream stream = pl_stream_of(frame->seed, PL_DRAW_SHOT, i, frame->index);
    frame->electrons[i] = pl_stream_poisson(&stream, frame->electrons[i]);
  }
}

pl_status pl_stage_shot_noise(pl_sensor_frame *frame, int value) {
  (void)value;
  return pl_sensor_rows(frame, count_row);
}

/* Values above white are clipped, so the deviation is at most that at white. It would be most
 * visible on black, since the encoding is concave. */
static double bound_dn(const pl_view *view, int value) {
  if (value > 0)
    return 0.0;
  const double mean = fmin(pl_sensor_white_electrons(view->sensor), pl_sensor_charge_max(view));
  return pl_sensor_dn(view, pl_poisson_most(mean) - mean);
}

static double cost_ms(const pl_view *view, int value) {
  return pl_sensor_cost_ms(view, 100.0 * value);
}

const pl_effect pl_effect_shot_noise = {
    .name = "shot_noise",
    .doc = "Sensor: Poisson noise of the collected electrons",
    .absent = pl_sensor_absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
