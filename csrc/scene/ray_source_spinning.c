/* Rotating LiDAR: a column of beams that turns about the sensor's y axis. */
#include "scene/ray_source.h"

enum { FROM, TO, STEPS, RATE };
static const pl_ray_value values[] = {
    {"from_rad", "azimuth of the first column, to the right of z", -100.0, 100.0, false},
    {"to_rad", "azimuth where the column after the last would be", -100.0, 100.0, false},
    {"steps", "columns", 1.0, 1e7, true},
    {"rate_hz", "columns per second", 1e-9, 1e12, false},
};

static size_t count(const pl_ray_source *source) {
  return (size_t)source->value[STEPS] * source->list_count;
}

static double duration_s(const pl_ray_source *source) {
  return (source->value[STEPS] - 1.0) / source->value[RATE];
}

static void ray(const pl_ray_source *source, size_t index, int sub, pl_sensor_ray *out) {
  const double *v = source->value;
  const size_t step = index / source->list_count, channel = index % source->list_count;
  const double part = (double)step / v[STEPS];
  (void)sub;
  out->origin = (pl_vec3){0.0, 0.0, 0.0};
  out->direction = pl_ray_angles(v[FROM] + part * (v[TO] - v[FROM]), source->list[channel]);
  out->time_s = (double)step / v[RATE];
  out->line = (int32_t)channel;
}

const pl_ray_source_kind pl_ray_source_spinning = {
    .name = "spinning",
    .doc = "a column of beams at given elevations that turns about the sensor's y axis",
    .values = values,
    .value_count = sizeof values / sizeof values[0],
    .list = "elevations_rad",
    .list_row = 1,
    .count = count,
    .duration_s = duration_s,
    .ray = ray,
};
