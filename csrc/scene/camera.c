/* Conversion between pixels and directions. */
#include "scene/scene.h"

/* Inverse of K: from a pixel to the image plane at unit focal length. */
static pl_vec3 plane_point(const pl_camera *camera, double u, double v) {
  const double y = (v - camera->cy) / camera->fy;
  return (pl_vec3){(u - camera->cx - camera->skew * y) / camera->fx, y, 1.0};
}

static void pixel_of(const pl_camera *camera, pl_vec3 plane, double pixel[2]) {
  pixel[0] = camera->fx * plane.x + camera->skew * plane.y + camera->cx;
  pixel[1] = camera->fy * plane.y + camera->cy;
}

pl_vec3 pl_camera_ray(const pl_camera *camera, double u, double v) {
  const pl_vec3 plane = plane_point(camera, u, v);
  if (camera->lens.model == NULL)
    return plane;
  pl_vec3 direction;
  return pl_lens_unproject(&camera->lens, plane.x, plane.y, &direction) ? direction
                                                                        : (pl_vec3){0.0, 0.0, 0.0};
}

bool pl_camera_project(const pl_camera *camera, pl_vec3 direction, double pixel[2]) {
  pl_vec3 plane = {direction.x / direction.z, direction.y / direction.z, 1.0};
  if (camera->lens.model == NULL ? !(direction.z > 0.0)
                                 : !pl_lens_project(&camera->lens, direction, &plane))
    return false;
  pixel_of(camera, plane, pixel);
  return true;
}

/* Returns the half angle of the cone about the mean of the points' directions that contains them
 * all. */
static double cone_about(const pl_vec3 *points, size_t count, pl_vec3 *axis) {
  *axis = (pl_vec3){0.0, 0.0, 0.0};
  for (size_t i = 0; i < count; i++)
    *axis = pl_vec3_add(*axis, pl_vec3_unit(points[i]));
  *axis = pl_vec3_unit(*axis);
  double widest = 0.0;
  for (size_t i = 0; i < count; i++) {
    const double sine = pl_vec3_norm(pl_vec3_cross(points[i], *axis));
    widest = fmax(widest, atan2(sine, pl_vec3_dot(points[i], *axis)));
  }
  return widest;
}

void pl_camera_bound(const pl_camera *camera, const pl_vec3 *points, size_t count, double rect[4]) {
  /* a cone is convex only up to a half angle of 90 degrees */
  const double rounding_rad = 1e-7, wide = 1.5;
  pl_vec3 axis;
  const double half = cone_about(points, count, &axis) + rounding_rad;
  rect[0] = rect[1] = -INFINITY;
  rect[2] = rect[3] = INFINITY;
  if (!(half < wide))
    return;
  const pl_lens_extent e = pl_lens_bound(&camera->lens, axis, half);
  const double skew0 = camera->skew * (camera->skew > 0.0 ? e.y0 : e.y1);
  const double skew1 = camera->skew * (camera->skew > 0.0 ? e.y1 : e.y0);
  rect[0] = camera->fx * e.x0 + skew0 + camera->cx;
  rect[1] = camera->fy * e.y0 + camera->cy;
  rect[2] = camera->fx * e.x1 + skew1 + camera->cx;
  rect[3] = camera->fy * e.y1 + camera->cy;
}

/* Number of samples per side on the image border, and of the grid over the image. */
enum { BORDER = 64, GRID = 16 };

pl_status pl_camera_check_lens(const pl_camera *camera) {
  const pl_lens *lens = &camera->lens;
  const double w = camera->width, h = camera->height;
  for (int i = 0; lens->model != NULL && i < 4 * BORDER; i++) {
    const double along = (double)(i / 4) / (BORDER - 1), side = i % 2;
    const double u = -0.5 + w * (i % 4 < 2 ? along : side);
    const double v = -0.5 + h * (i % 4 < 2 ? side : along);
    if (pl_vec3_norm(pl_camera_ray(camera, u, v)) > 0.0)
      continue;
    if (!isfinite(lens->limit))
      return pl_fail(PL_E_RANGE,
                     "camera: the lens has no direction for pixel (%g, %g): an %s image spans at "
                     "most 360 by 180 deg",
                     u, v, lens->model->name);
    return pl_fail(PL_E_RANGE,
                   "camera: the lens %s: pixel (%g, %g) of the image lies beyond the angle of "
                   "%.4g deg off the axis, %.5g focal lengths from the principal point",
                   lens->limit_rad < lens->model->angle_max_rad
                       ? "folds the image over"
                       : "sees no farther than its model says",
                   u, v, lens->limit_rad * 180.0 / PL_PI, lens->limit);
  }
  return PL_OK;
}

double pl_camera_lens_shift(const pl_camera *camera) {
  double most = 0.0;
  for (int i = 0; camera->lens.model != NULL && i <= GRID; i++)
    for (int k = 0; k <= GRID; k++) {
      const double u = -0.5 + camera->width * (double)i / GRID;
      const double v = -0.5 + camera->height * (double)k / GRID;
      const pl_vec3 ray = pl_camera_ray(camera, u, v);
      double pixel[2];
      if (!(ray.z > 0.0))
        return INFINITY;
      pixel_of(camera, (pl_vec3){ray.x / ray.z, ray.y / ray.z, 1.0}, pixel);
      most = fmax(most, hypot(pixel[0] - u, pixel[1] - v));
    }
  return most;
}
