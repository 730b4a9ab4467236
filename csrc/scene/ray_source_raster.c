/* Raster scan: one beam that sweeps line by line, in turn to the right and to the left. */
#include "scene/ray_source.h"

enum { COLUMNS, ROWS, WIDTH, HEIGHT, RATE };
static const pl_ray_value values[] = {
    {"columns", "pulses per line", 1.0, 65536.0, true},
    {"rows", "lines", 1.0, 65536.0, true},
    {"width_rad", "angle of a line", 0.0, 6.2831853, false},
    {"height_rad", "angle from the first line to the last", 0.0, 3.1415926, false},
    {"rate_hz", "pulses per second", 1e-9, 1e12, false},
};

static size_t count(const pl_ray_source *source) {
  return (size_t)source->value[COLUMNS] * (size_t)source->value[ROWS];
}

static double duration_s(const pl_ray_source *source) {
  return ((double)count(source) - 1.0) / source->value[RATE];
}

/* From -1/2 to 1/2; 0 for a single step. */
static double centred(size_t step, double steps) {
  return steps > 1.0 ? (double)step / (steps - 1.0) - 0.5 : 0.0;
}

static void ray(const pl_ray_source *source, size_t index, int sub, pl_sensor_ray *out) {
  const double *v = source->value;
  const size_t columns = (size_t)v[COLUMNS], row = index / columns, step = index % columns;
  const double x = centred(row % 2 == 0 ? step : columns - 1 - step, v[COLUMNS]);
  (void)sub;
  out->origin = (pl_vec3){0.0, 0.0, 0.0};
  out->direction = pl_ray_angles(x * v[WIDTH], -centred(row, v[ROWS]) * v[HEIGHT]);
  out->time_s = (double)index / v[RATE];
  out->line = (int32_t)row;
}

const pl_ray_source_kind pl_ray_source_raster = {
    .name = "raster",
    .doc = "one beam that sweeps line by line, in turn to the right and to the left",
    .values = values,
    .value_count = sizeof values / sizeof values[0],
    .count = count,
    .duration_s = duration_s,
    .ray = ray,
};
