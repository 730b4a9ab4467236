/* Flash LiDAR: a grid of beams that all leave at once, as the pixels of a pinhole camera. */
#include "scene/ray_source.h"

enum { COLUMNS, ROWS, WIDTH, HEIGHT };
static const pl_ray_value values[] = {
    {"columns", "beams per row", 1.0, 65536.0, true},
    {"rows", "rows", 1.0, 65536.0, true},
    {"width_rad", "angle from the left edge to the right one", 1e-9, 3.1, false},
    {"height_rad", "angle from the top edge to the bottom one", 1e-9, 3.1, false},
};

static size_t count(const pl_ray_source *source) {
  return (size_t)source->value[COLUMNS] * (size_t)source->value[ROWS];
}

static double duration_s(const pl_ray_source *source) {
  (void)source;
  return 0.0;
}

static void ray(const pl_ray_source *source, size_t index, int sub, pl_sensor_ray *out) {
  const double *v = source->value;
  const size_t columns = (size_t)v[COLUMNS];
  const double x = 2.0 * ((double)(index % columns) + 0.5) / v[COLUMNS] - 1.0;
  const double y = 2.0 * ((double)(index / columns) + 0.5) / v[ROWS] - 1.0;
  (void)sub;
  out->origin = (pl_vec3){0.0, 0.0, 0.0};
  out->direction = pl_vec3_unit((pl_vec3){x * tan(0.5 * v[WIDTH]), y * tan(0.5 * v[HEIGHT]), 1.0});
  out->time_s = 0.0;
  out->line = (int32_t)(index / columns);
}

const pl_ray_source_kind pl_ray_source_flash = {
    .name = "flash",
    .doc = "a grid of beams that all leave at once",
    .values = values,
    .value_count = sizeof values / sizeof values[0],
    .count = count,
    .duration_s = duration_s,
    .ray = ray,
};
