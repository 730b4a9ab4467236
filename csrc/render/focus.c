/* The thin lens: circle of confusion after Potmesil and Chakravarty 1981, sampling after Cook,
 * Porter and Carpenter 1984. In the plane of focus F, the image equals that of a pinhole. With fx
 * in pixels and an aperture of diameter D, a point at depth z therefore spreads over a disc of fx D
 * |1/z - 1/F| pixels in diameter. */
#include "render/focus.h"

#include "math/sampler.h"
#include "math/sampling.h"

/* A dimension pair that no path reaches: those of paths are counted from 0, three per bounce. */
static const uint32_t LENS_DIMENSION = UINT32_C(0x4c454e53);

static pl_vec3 optical_axis(const pl_snapshot *shot) {
  return pl_mat3_mul_vec(shot->camera_to_root, (pl_vec3){0.0, 0.0, 1.0});
}

void pl_focus_beam(const pl_snapshot *shot, uint32_t index, uint32_t seed, pl_beam *beam) {
  float u[2];
  pl_sample_2d(index, seed, LENS_DIMENSION, u);
  const pl_vec3f disc = pl_sample_disc(u[0], u[1]);
  const double radius = 0.5 * shot->camera.aperture_m;
  const pl_vec3 point = {radius * disc.x, radius * disc.y, 0.0};
  const double depth = pl_vec3_dot(beam->direction, optical_axis(shot));
  beam->origin = pl_mat3_mul_vec(shot->camera_to_root, point);
  const pl_vec3 ahead = pl_vec3_scale(beam->direction, 1.0 / depth);
  beam->direction = pl_vec3_unit(pl_vec3_madd(ahead, -shot->camera.focus_per_m, beam->origin));
}

void pl_focus_widen(const pl_snapshot *shot, int samples, double t, pl_beam *beam) {
  const double depth = t * pl_vec3_dot(beam->direction, optical_axis(shot));
  const double across = shot->camera.aperture_m * fabs(1.0 - depth * shot->camera.focus_per_m);
  beam->width_m += (float)(across / sqrt((double)samples));
}
