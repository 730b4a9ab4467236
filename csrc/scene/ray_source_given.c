/* Rays that the caller lists. */
#include "scene/ray_source.h"

enum { ROW = 7 };

static size_t count(const pl_ray_source *source) { return source->list_count; }

static double duration_s(const pl_ray_source *source) {
  double last = 0.0;
  for (size_t i = 0; i < source->list_count; i++)
    last = fmax(last, source->list[ROW * i + 6]);
  return last;
}

static void ray(const pl_ray_source *source, size_t index, int sub, pl_sensor_ray *out) {
  const double *row = source->list + ROW * index;
  (void)sub;
  out->origin = (pl_vec3){row[0], row[1], row[2]};
  out->direction = pl_vec3_unit((pl_vec3){row[3], row[4], row[5]});
  out->time_s = row[6];
  out->line = 0;
}

const pl_ray_source_kind pl_ray_source_given = {
    .name = "given",
    .doc = "rays one by one: origin, direction (of any length), time",
    .list = "rays",
    .list_row = ROW,
    .count = count,
    .duration_s = duration_s,
    .ray = ray,
};
