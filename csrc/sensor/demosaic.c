/* The stage `demosaic`: converts digital numbers to the 8-bit image. Subtracts the black level,
 * interpolates each band bilinearly from the nearest pixels with that filter, applies the white
 * balance that makes a sunlit white surface grey, and encodes for display. White is the level at
 * which the most sensitive pixels are full. */
#include <math.h>

#include "sensor/stages.h"

/* Value of `band` at a pixel: the pixel's own value if it has that filter, otherwise the mean over
 * those neighbours inside the image (dx, dy in -1..1) that have it, with the bilinear weights 4, 2
 * and 1 by distance. */
static double interpolate(const pl_sensor_frame *frame, int x, int y, int band) {
  const pl_mosaic mosaic = frame->sensor->mosaic;
  const size_t width = (size_t)frame->width;
  double sum = 0.0, weights = 0.0;
  if (pl_sensor_band(mosaic, x, y) == band)
    return frame->raw[(size_t)y * width + (size_t)x];
  for (int dy = -1; dy <= 1; dy++)
    for (int dx = -1; dx <= 1; dx++) {
      const int u = x + dx, v = y + dy;
      if (u < 0 || v < 0 || u >= frame->width || v >= frame->height ||
          pl_sensor_band(mosaic, u, v) != band)
        continue;
      const double weight = (dx == 0 ? 2.0 : 1.0) * (dy == 0 ? 2.0 : 1.0);
      sum += weight * frame->raw[(size_t)v * width + (size_t)u];
      weights += weight;
    }
  /* An image of a single row or column lacks some bands; they come out black. */
  return weights > 0.0 ? sum / weights : frame->sensor->black_level;
}

static void develop_row(pl_sensor_frame *frame, int y) {
  const pl_sensor *sensor = frame->sensor;
  const double white = pl_sensor_white_electrons(sensor) / sensor->gain;
  double scale[3];
  for (int band = 0; band < 3; band++)
    scale[band] = pl_sensor_balance(sensor, band) / white;
  uint8_t *out = frame->rgb + 3 * (size_t)y * (size_t)frame->width;
  for (int x = 0; x < frame->width; x++)
    for (int band = 0; band < 3; band++) {
      const int seen = sensor->mosaic == PL_MOSAIC_MONO ? 1 : band;
      const double number = interpolate(frame, x, y, seen) - sensor->black_level;
      *out++ = pl_encode(frame->encoder, (float)(scale[band] * number));
    }
}

pl_status pl_stage_demosaic(pl_sensor_frame *frame, int value) {
  (void)value;
  return frame->rgb == NULL ? PL_OK : pl_sensor_rows(frame, develop_row);
}
