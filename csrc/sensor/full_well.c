/* The stage `full_well`: limits the charge of a pixel to the full-well capacity. */
#include <math.h>

#include "sensor/stages.h"

static void clip_row(pl_sensor_frame *frame, int y) {
  const size_t first = (size_t)y * (size_t)frame->width;
  for (size_t i = first; i < first + (size_t)frame->width; i++)
    frame->electrons[i] = fmin(frame->electrons[i], frame->sensor->full_well);
}

pl_status pl_stage_full_well(pl_sensor_frame *frame, int value) {
  (void)value;
  return pl_sensor_rows(frame, clip_row);
}
