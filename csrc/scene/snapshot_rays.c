/* Vectorised rays of neighbouring pixels. */
#include "base/wide.h"
#include "scene/snapshot.h"

/* The same operations as in pl_camera_ray without a lens and in pl_snapshot_ray. */
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

void pl_snapshot_rays(const pl_snapshot *shot, int u0, int v, size_t count, double *x, double *y,
                      double *z) {
  if (shot->camera.lens.model == NULL) {
    fill_pinhole(&shot->camera, &shot->camera_to_root, u0, v, count, x, y, z);
    return;
  }
  for (size_t i = 0; i < count; i++) {
    const pl_vec3 ray = pl_snapshot_ray(shot, u0 + (double)i, v);
    x[i] = ray.x;
    y[i] = ray.y;
    z[i] = ray.z;
  }
}
