/* Automatic exposure: chooses exposure time and gain from a small preview image. */
#include "sensor/metering.h"

#include <math.h>
#include <stdlib.h>

#include "sensor/exposure.h"

/* Copies the pixels whose centres lie in the window, or the pixel nearest to its centre if there
 * are none. Returns their number. */
static size_t cut_out(const double window[4], const float *signals, int width, int height,
                      float *out) {
  size_t count = 0;
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++) {
      const double u = (x + 0.5) / width, v = (y + 0.5) / height;
      if (u >= window[0] && u <= window[2] && v >= window[1] && v <= window[3])
        out[count++] = signals[(size_t)y * (size_t)width + (size_t)x];
    }
  if (count > 0)
    return count;
  const int x = (int)fmin(width - 1.0, 0.5 * (window[0] + window[2]) * width);
  const int y = (int)fmin(height - 1.0, 0.5 * (window[1] + window[3]) * height);
  out[0] = signals[(size_t)y * (size_t)width + (size_t)x];
  return 1;
}

static double mean(const float *signals, size_t count) {
  double sum = 0.0;
  for (size_t i = 0; i < count; i++)
    sum += signals[i] > 0.0f ? fmin((double)signals[i], 1e30) : 0.0;
  return sum / (double)count;
}

double pl_sensor_meter(const pl_auto_time *how, const float *signals, int width, int height,
                       float *scratch, double fallback) {
  const pl_exposure exposure = {.percentile = how->percentile, .key = how->key};
  const size_t count = cut_out(how->window, signals, width, height, scratch);
  const double average = mean(scratch, count);
  /* sorts the signals, and sets NaN and negative ones to 0 */
  double white = pl_exposure_meter(&exposure, scratch, count, fallback);
  if (how->mean)
    white = average > 0.0 ? average / how->key : fallback;
  const size_t free = (size_t)floor(how->saturated * (double)count);
  return free < count ? fmax(white, (double)scratch[count - 1 - free]) : white;
}

/* Exposure time that brings the radiance to white, s, or the longest time if the radiance is 0. */
static double wanted_s(const pl_sensor *sensor, double radiance) {
  pl_sensor second = *sensor;
  second.exposure_s = 1.0;
  const double rate = radiance * pl_sensor_response_white(&second);
  return rate > 0.0 ? pl_sensor_white_electrons(sensor) / rate : sensor->auto_time.max_s;
}

/* The longest allowed time that does not exceed the wanted one. */
static double allowed_s(const pl_auto_time *how, double time_s) {
  if (how->step_s > 0.0)
    time_s = how->step_s * floor(time_s / how->step_s);
  time_s = fmin(how->max_s, fmax(how->min_s, time_s));
  if (how->time_count == 0)
    return time_s;
  double out = how->times_s[0];
  for (int i = 1; i < how->time_count && how->times_s[i] <= time_s; i++)
    out = how->times_s[i];
  return out;
}

void pl_sensor_expose(pl_sensor *sensor, double radiance) {
  const pl_auto_time *how = &sensor->auto_time;
  const double base = sensor->gain;
  double time_s = wanted_s(sensor, radiance);
  for (int i = 0; i < how->gain_count; i++) {
    sensor->gain = base / how->gains[i];
    time_s = wanted_s(sensor, radiance);
    if (time_s <= how->max_s)
      break;
  }
  sensor->exposure_s = allowed_s(how, time_s);
}
