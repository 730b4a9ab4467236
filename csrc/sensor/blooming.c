/* The stage `blooming`: the charge in excess of a CCD pixel's full well flows along its column,
 * half up and half down, and fills one pixel after another. Charge is lost where it leaves the ends
 * of the column, and the anti-blooming drain removes a fraction of each excess. Otherwise charge is
 * conserved. */
#include <math.h>

#include "plan/effects.h"
#include "sensor/stages.h"

/* Moves the charge that flows in one direction; `step` is +-1. */
static void flow(pl_sensor_frame *frame, int x, int first, int step) {
  const size_t width = (size_t)frame->width;
  const double well = frame->sensor->full_well;
  double carried = 0.0;
  for (int y = first; y >= 0 && y < frame->height; y += step) {
    double *pixel = &frame->electrons[(size_t)y * width + (size_t)x];
    const double total = *pixel;
    if (total > well) { /* a source: half of its excess joins the flow, and its well stays full */
      carried += 0.5 * (1.0 - frame->sensor->drain) * (total - well);
    } else {
      const double taken = fmin(carried, well - total);
      *pixel += taken;
      carried -= taken;
    }
  }
}

static void bloom_column(pl_sensor_frame *frame, int x) {
  flow(frame, x, 0, 1);
  flow(frame, x, frame->height - 1, -1);
}

pl_status pl_stage_blooming(pl_sensor_frame *frame, int value) {
  (void)value;
  return pl_sensor_columns(frame, bloom_column); /* the stage `full_well` then clips the sources */
}

static const char *absent(const pl_view *view) {
  const char *none = pl_sensor_absent(view);
  if (none != NULL)
    return none;
  if (!(view->sensor->drain < 1.0))
    return "the drain removes all excess charge";
  return pl_sensor_charge_max(view) > view->sensor->full_well ? NULL : "no pixel is saturated";
}

/* The excess of a whole column may end up in one pixel. */
static double bound_dn(const pl_view *view, int value) {
  const double excess = pl_sensor_charge_max(view) - view->sensor->full_well;
  return value > 0 ? 0.0 : pl_sensor_dn(view, view->height * excess);
}

static double cost_ms(const pl_view *view, int value) {
  return pl_sensor_cost_ms(view, 20.0 * value);
}

const pl_effect pl_effect_blooming = {
    .name = "blooming",
    .doc = "Sensor: charge of saturated pixels spills along their columns",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
