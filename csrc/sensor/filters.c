/* The stage `filters`: crosstalk of the colour filters of a mosaic. Real filters overlap, so each
 * responds to all three colours of the light. If the stage is off, each filter responds to its own
 * colour only, with the same response to white light. */
#include <math.h>

#include "plan/effects.h"
#include "sensor/stages.h"

static void mix_row(pl_sensor_frame *frame, int y) {
  const double(*m)[3] = frame->sensor->mix;
  pl_vec3f *row = frame->bands + (size_t)y * (size_t)frame->width;
  for (int x = 0; x < frame->width; x++) {
    const double r = row[x].x, g = row[x].y, b = row[x].z;
    row[x] = (pl_vec3f){(float)(m[0][0] * r + m[0][1] * g + m[0][2] * b),
                        (float)(m[1][0] * r + m[1][1] * g + m[1][2] * b),
                        (float)(m[2][0] * r + m[2][1] * g + m[2][2] * b)};
  }
}

pl_status pl_stage_filters(pl_sensor_frame *frame, int value) {
  (void)value;
  return frame->sensor->mixed ? pl_sensor_rows(frame, mix_row) : PL_OK;
}

/* Largest fraction of a filter's signal that comes from the other colours. */
static double foreign(const pl_sensor *sensor) {
  double part = 0.0;
  for (int band = 0; band < 3 && sensor->mixed; band++)
    part = fmax(part, 1.0 - sensor->mix[band][band]);
  return part;
}

static const char *absent(const pl_view *view) {
  const char *none = pl_sensor_absent(view);
  if (none != NULL)
    return none;
  return foreign(view->sensor) > 0.0 ? NULL : "every filter transmits only its own colour";
}

/* The other colours may have any radiance between 0 and the brightest light. */
static double bound_dn(const pl_view *view, int value) {
  const double part = foreign(view->sensor);
  if (value > 0 || part == 0.0)
    return 0.0;
  return pl_sensor_light_dn(view, part * pl_sensor_electrons_max(view));
}

static double cost_ms(const pl_view *view, int value) {
  return pl_sensor_cost_ms(view, 3.0 * value);
}

const pl_effect pl_effect_filters = {
    .name = "filters",
    .doc = "Sensor: spectral overlap of the colour filters; off: each passes its own colour only",
    .absent = absent,
    .ceiling = pl_effect_ceiling_one,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
