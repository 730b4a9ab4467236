/* The stage `digitise`: converts electrons to digital numbers by gain, black level, rounding and
 * clipping to the bit depth. */
#include <math.h>

#include "sensor/stages.h"

static void convert_row(pl_sensor_frame *frame, int y) {
  const pl_sensor *sensor = frame->sensor;
  const double most = (double)((1u << sensor->bits) - 1u);
  const size_t first = (size_t)y * (size_t)frame->width;
  for (size_t i = first; i < first + (size_t)frame->width; i++) {
    const double number = floor(frame->electrons[i] / sensor->gain + sensor->black_level + 0.5);
    frame->raw[i] = (uint16_t)fmin(fmax(number, 0.0), most);
  }
}

pl_status pl_stage_digitise(pl_sensor_frame *frame, int value) {
  (void)value;
  return pl_sensor_rows(frame, convert_row);
}
