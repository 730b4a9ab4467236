/* Rays of a camera's pixels: those that its labels are made of. */
#include "scene/ray_source.h"

static size_t count(const pl_ray_source *source) {
  return (size_t)source->camera.width * (size_t)source->camera.height;
}

/* The middle of a row's exposure. */
static double time_of(const pl_ray_source *source, int row) {
  return row * source->shutter.line_s + 0.5 * source->shutter.exposure_s;
}

static double duration_s(const pl_ray_source *source) {
  return time_of(source, source->camera.height - 1);
}

static void ray(const pl_ray_source *source, size_t index, int sub, pl_sensor_ray *out) {
  const int column = (int)(index % (size_t)source->camera.width);
  const int row = (int)(index / (size_t)source->camera.width);
  /* sub-rays fill a square grid row by row; what is over stays in its last row */
  const int side = (int)ceil(sqrt((double)source->sub_rays)), last = sub / side;
  const int rows = (source->sub_rays + side - 1) / side;
  const int in_row = last + 1 < rows ? side : source->sub_rays - side * (rows - 1);
  const double u = column + (sub % side + 0.5) / in_row - 0.5;
  const double v = row + (last + 0.5) / rows - 0.5;
  out->origin = (pl_vec3){0.0, 0.0, 0.0};
  out->direction = pl_vec3_unit(pl_camera_ray(&source->camera, u, v));
  out->time_s = time_of(source, row);
  out->line = row;
}

const pl_ray_source_kind pl_ray_source_pixels = {
    .name = "pixels",
    .doc = "the pixels of the frame's camera, row by row, each row in the middle of its exposure",
    .camera = true,
    .fills_area = true,
    .count = count,
    .duration_s = duration_s,
    .ray = ray,
};
