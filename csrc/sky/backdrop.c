/* Radiance of background images over pixels. */
#include "sky/backdrop.h"

#include "shade/body_map.h"

double pl_backdrop_max(const pl_backdrop *backdrop) {
  float mean[4];
  int levels;
  double most = 0.0;
  pl_texture_mean(backdrop->texture, mean);
  const float *ranges = pl_texture_ranges(backdrop->texture, &levels);
  for (int band = 0; band < 3; band++)
    most = fmax(most, (double)(pl_minf(mean[band] + ranges[0], 1.0f) * backdrop->white[band]));
  return most;
}

/* Difference of the directions on both sides of a pixel; where the lens has no ray on one side,
 * twice the difference to the other side. */
static pl_vec3 across(const pl_snapshot *shot, pl_vec3 middle, double x, double y, double dx,
                      double dy) {
  pl_vec3 before = pl_snapshot_ray(shot, x - dx, y - dy);
  pl_vec3 after = pl_snapshot_ray(shot, x + dx, y + dy);
  if (pl_vec3_dot(before, before) == 0.0)
    before = pl_vec3_sub(pl_vec3_scale(middle, 2.0), after);
  if (pl_vec3_dot(after, after) == 0.0)
    after = pl_vec3_sub(pl_vec3_scale(middle, 2.0), before);
  return pl_vec3_sub(after, before);
}

static void read_map(const pl_backdrop *backdrop, const pl_snapshot *shot, int x, int y,
                     float out[4]) {
  const pl_vec3 middle = pl_snapshot_ray(shot, x, y);
  const pl_body_place place = {
      .point = pl_mat3_mul_vec(backdrop->from_root, middle),
      .across = pl_mat3_mul_vec(backdrop->from_root, across(shot, middle, x, y, 0.5, 0.0)),
      .along = pl_mat3_mul_vec(backdrop->from_root, across(shot, middle, x, y, 0.0, 0.5))};
  pl_body_map_sample(backdrop->texture, &place, PL_FILTER_FINEST, out);
}

static void read_image(const pl_backdrop *backdrop, const pl_camera *camera, int x, int y,
                       float out[4]) {
  int width, height, channels;
  pl_texture_size(backdrop->texture, &width, &height, &channels);
  /* Extent of a pixel as a fraction of the image. */
  double du = 1.0 / camera->width, dv = 1.0 / camera->height;
  if (backdrop->kind == PL_BACKDROP_COVER) {
    const double pixels = fmax((double)camera->width / width, (double)camera->height / height);
    du = 1.0 / (pixels * width);
    dv = 1.0 / (pixels * height);
  }
  const float a[2] = {(float)du, 0.0f}, b[2] = {0.0f, (float)dv};
  const double u = 0.5 + du * (x + 0.5 - 0.5 * camera->width);
  const double v = 0.5 + dv * (y + 0.5 - 0.5 * camera->height);
  pl_texture_sample(backdrop->texture, (float)u, (float)v, a, b, PL_FILTER_FINEST, out);
}

pl_vec3f pl_backdrop_radiance(const pl_backdrop *backdrop, const pl_snapshot *shot, int x, int y) {
  float value[4];
  if (backdrop->kind == PL_BACKDROP_MAP)
    read_map(backdrop, shot, x, y, value);
  else
    read_image(backdrop, &shot->rays.camera, x, y, value);
  return (pl_vec3f){value[0] * backdrop->white[0], value[1] * backdrop->white[1],
                    value[2] * backdrop->white[2]};
}
