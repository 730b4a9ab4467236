/* Rays of a camera's image: pinhole, and lenses of all models, with rolling rows. */
#include "base/wide.h"
#include "scene/ray_source.h"

static size_t count(const pl_ray_source *source) {
  return (size_t)source->camera.width * (size_t)source->camera.height;
}

static double duration_s(const pl_ray_source *source) {
  return pl_shutter_row_s(&source->shutter, source->camera.height - 1);
}

static pl_vec3 at(const pl_ray_source *source, double u, double v) {
  return pl_vec3_unit(pl_camera_ray(&source->camera, u, v));
}

/* The same operations as in `at` without a lens. */
PL_WIDE static void fill_pinhole(const pl_camera *camera, const pl_mat3 *to_root, double u0,
                                 double v, size_t count, double *restrict x, double *restrict y,
                                 double *restrict z) {
  const pl_mat3 m = *to_root;
  const double cx = camera->cx, fx = camera->fx;
  const double plane_y = (v - camera->cy) / camera->fy, shear = camera->skew * plane_y;
  for (size_t i = 0; i < count; i++) {
    const double u = u0 + (double)(int)i;
    const pl_vec3 plane = {(u - cx - shear) / fx, plane_y, 1.0};
    const pl_vec3 ray = pl_mat3_mul_vec(m, pl_vec3_unit(plane));
    x[i] = ray.x;
    y[i] = ray.y;
    z[i] = ray.z;
  }
}

static bool row(const pl_ray_source *source, const pl_mat3 *turn, int u0, int v, size_t count,
                double *x, double *y, double *z) {
  if (source->camera.lens.model != NULL)
    return false;
  fill_pinhole(&source->camera, turn, u0, v, count, x, y, z);
  return true;
}

static void ray(const pl_ray_source *source, size_t index, int sub, pl_sensor_ray *out) {
  const int column = (int)(index % (size_t)source->camera.width);
  const int line = (int)(index / (size_t)source->camera.width);
  /* sub-rays fill a square grid row by row; what is over stays in its last row */
  const int side = (int)ceil(sqrt((double)source->sub_rays)), last = sub / side;
  const int rows = (source->sub_rays + side - 1) / side;
  const int in_row = last + 1 < rows ? side : source->sub_rays - side * (rows - 1);
  const double u = column + (sub % side + 0.5) / in_row - 0.5;
  const double v = line + (last + 0.5) / rows - 0.5;
  out->origin = (pl_vec3){0.0, 0.0, 0.0};
  out->direction = at(source, u, v);
  out->time_s = pl_shutter_row_s(&source->shutter, line);
  out->line = line;
}

const pl_ray_source_kind pl_ray_source_pixels = {
    .name = "pixels",
    .doc = "the pixels of the frame's camera, row by row, each row in the middle of its exposure",
    .camera = true,
    .fills_area = true,
    .count = count,
    .duration_s = duration_s,
    .ray = ray,
    .at = at,
    .row = row,
    .projects = true,
};
