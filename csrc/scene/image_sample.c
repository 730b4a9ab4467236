/* The thin lens: circle of confusion after Potmesil and Chakravarty 1981, sampling after Cook,
 * Porter and Carpenter 1984. In the plane of focus F, the image equals that of a pinhole. With fx
 * in pixels and an aperture of diameter D, a point at depth z therefore spreads over a disc of fx D
 * |1/z - 1/F| pixels in diameter. */
#include "scene/image_sample.h"

#include "math/sampler.h"
#include "math/sampling.h"

/* Pairs of dimensions that no path reaches: those of paths are counted from 0, three per bounce. */
static const uint32_t LENS_DIMENSION = UINT32_C(0x4c454e53);
static const uint32_t TIME_DIMENSION = UINT32_C(0x54494d45);

void pl_image_sample_offset(uint32_t index, int samples, double offset[2]) {
  const uint32_t half = UINT32_C(1) << 31;
  const uint32_t x = pl_sampler_reverse_bits(index) ^ half;
  const uint32_t y = pl_sampler_reverse_bits(pl_sampler_pascal(index)) ^ half;
  const double cell = 0.5 / samples;
  offset[0] = index == 0 ? 0.0 : 0x1p-32 * x + cell - 0.5;
  offset[1] = index == 0 ? 0.0 : 0x1p-32 * y + cell - 0.5;
}

static pl_vec3 optical_axis(const pl_snapshot *shot) {
  return pl_mat3_mul_vec(shot->camera_to_root, (pl_vec3){0.0, 0.0, 1.0});
}

/* Moves a ray through the centre of the lens to the lens point of the sample. */
static void leave_lens(const pl_snapshot *shot, uint32_t index, uint32_t seed, pl_vec3 *origin,
                       pl_vec3 *direction) {
  float u[2];
  pl_sample_2d(index, seed, LENS_DIMENSION, u);
  const pl_vec3f disc = pl_sample_disc(u[0], u[1]);
  const double radius = 0.5 * shot->rays.camera.aperture_m;
  const pl_vec3 point = {radius * disc.x, radius * disc.y, 0.0};
  const double depth = pl_vec3_dot(*direction, optical_axis(shot));
  *origin = pl_mat3_mul_vec(shot->camera_to_root, point);
  const pl_vec3 ahead = pl_vec3_scale(*direction, 1.0 / depth);
  *direction = pl_vec3_unit(pl_vec3_madd(ahead, -shot->rays.camera.focus_per_m, *origin));
}

void pl_image_sample_ray(const pl_snapshot *shot, uint32_t index, const double offset[2], int x,
                         int y, uint32_t seed, pl_vec3 *origin, pl_vec3 *direction) {
  /* A few samples are not symmetric about the centre. Random signs remove the mean shift. */
  const double u = seed & 1u ? -offset[0] : offset[0];
  const double v = seed & 2u ? -offset[1] : offset[1];
  *origin = (pl_vec3){0.0, 0.0, 0.0};
  *direction = pl_snapshot_ray(shot, x + u, y + v);
  if (shot->rays.camera.aperture_m > 0.0)
    leave_lens(shot, index, seed, origin, direction);
}

double pl_image_confusion_m(const pl_snapshot *shot, pl_vec3 direction, double t) {
  const double depth = t * pl_vec3_dot(direction, optical_axis(shot));
  return shot->rays.camera.aperture_m * fabs(1.0 - depth * shot->rays.camera.focus_per_m);
}

/* Time of a sample within its own part of the exposure, 0..1. */
static double part_of(uint32_t seed, int sample) {
  return 0x1p-32 * pl_sampler_mix(seed ^ pl_sampler_mix((uint32_t)sample + TIME_DIMENSION));
}

bool pl_slice_has(const pl_slice *slice, int y, uint32_t seed, int sample, int samples) {
  const double t_s = slice->offset_s + y * slice->row_s +
                     slice->spread_s * (sample + part_of(seed, sample)) / samples;
  const double at = floor((t_s - slice->start_s) / slice->span_s * slice->count);
  return (int)fmin(fmax(at, 0.0), slice->count - 1) == slice->instant;
}

void pl_slice_range(const pl_slice *slice, int y, int samples, int range[2]) {
  const double rounding = 1e-6;
  range[0] = 0;
  range[1] = samples;
  if (!(slice->spread_s > 0.0))
    return;
  const double length_s = slice->span_s / slice->count;
  const double open_s = slice->offset_s + y * slice->row_s;
  for (int i = 0; i < 2; i++) {
    const double end_s = slice->start_s + length_s * (slice->instant + i) - open_s;
    const double at = end_s / slice->spread_s * samples;
    const bool outer = i == 0 ? slice->instant == 0 : slice->instant == slice->count - 1;
    if (!outer)
      range[i] =
          (int)fmin(fmax(i == 0 ? floor(at - rounding) : floor(at + rounding) + 1.0, 0.0), samples);
  }
}
