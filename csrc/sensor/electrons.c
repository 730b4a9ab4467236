/* The stage `electrons`: mean number of photoelectrons in each pixel behind its filter. */
#include <math.h>

#include "sensor/stages.h"

/* Upper limit of the charge, far above that of any sensor; keeps sums finite. */
static const double MOST_ELECTRONS = 1e30;

static void convert_row(pl_sensor_frame *frame, int y) {
  const pl_sensor *sensor = frame->sensor;
  const double response[3] = {pl_sensor_response(sensor, 0), pl_sensor_response(sensor, 1),
                              pl_sensor_response(sensor, 2)};
  const size_t first = (size_t)y * (size_t)frame->width;
  for (int x = 0; x < frame->width; x++) {
    const pl_vec3f light = frame->bands[first + (size_t)x];
    const double bands[3] = {light.x, light.y, light.z};
    const int band = pl_sensor_band(sensor->mosaic, x, y);
    const double electrons =
        sensor->mosaic == PL_MOSAIC_MONO
            ? bands[0] * response[0] + bands[1] * response[1] + bands[2] * response[2]
            : bands[band] * response[band];
    /* fmax drops NaN: a pixel without a valid radiance stays dark */
    frame->electrons[first + (size_t)x] = fmin(fmax(0.0, electrons), MOST_ELECTRONS);
  }
}

pl_status pl_stage_electrons(pl_sensor_frame *frame, int value) {
  (void)value;
  return pl_sensor_rows(frame, convert_row);
}
