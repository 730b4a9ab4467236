/* The stage `point_spread`: convolution with the lens's point-spread function. Light of a point
 * spreads to its neighbours, and by the wings over the whole image. Value 1 convolves with the
 * central part of the function, 2 with all of it. */
#include <math.h>
#include <string.h>

#include "sensor/convolve.h"
#include "plan/effects.h"
#include "sensor/psf.h"
#include "sensor/stages.h"

/* Half width of the central part, pixels. */
enum { REACH = 6 };

/* Radiance of a band of a pixel; 0 for NaN and negative values. */
static double band_of(const pl_sensor_frame *frame, size_t pixel, int band) {
  const pl_vec3f light = frame->bands[pixel];
  const float value = band == 0 ? light.x : band == 1 ? light.y : light.z;
  return value > 0.0f ? fmin((double)value, 1e30) : 0.0;
}

static void set_band(pl_vec3f *light, int band, double value) {
  const float kept = (float)fmax(0.0, value); /* clears rounding errors, 1e-17 of the brightest */
  if (band == 0)
    light->x = kept;
  else if (band == 1)
    light->y = kept;
  else
    light->z = kept;
}

/* --- direct convolution */

/* Pixels of a row that are summed together, so that their sums stay in the first-level cache. */
enum { BLOCK = 64 };

typedef struct direct {
  pl_sensor_frame *frame;
  int reach[2];
  double *kernels[3]; /* one per band */
  double *light[3];   /* copies of the bands */
} direct;

/* Adds the light that `count` pixels from (x, y) on receive in a band. */
static void gather(const direct *d, int x, int y, int count, int band, double sums[BLOCK]) {
  const int width = d->frame->width, height = d->frame->height;
  const int u_reach = d->reach[0], v_reach = d->reach[1];
  for (int v = -v_reach; v <= v_reach; v++) {
    if (y + v < 0 || y + v >= height)
      continue;
    /* light from (x + u, y + v) arrives with the offset (-u, -v) */
    const double *taps = d->kernels[band] + (v_reach - v) * (2 * u_reach + 1) + u_reach;
    const double *row = d->light[band] + (size_t)(y + v) * (size_t)width;
    for (int u = -u_reach; u <= u_reach; u++) {
      const int first = x + u < 0 ? -(x + u) : 0;
      const int last = x + u + count > width ? width - x - u : count;
      for (int i = first; i < last; i++)
        sums[i] += taps[-u] * row[x + u + i];
    }
  }
}

static pl_status direct_row(void *context, size_t row, int worker) {
  (void)worker;
  const direct *d = context;
  const int width = d->frame->width;
  pl_vec3f *out = d->frame->bands + row * (size_t)width;
  for (int x = 0; x < width; x += BLOCK)
    for (int band = 0; band < 3; band++) {
      const int count = width - x < BLOCK ? width - x : BLOCK;
      double sums[BLOCK] = {0.0};
      gather(d, x, (int)row, count, band, sums);
      for (int i = 0; i < count; i++)
        set_band(&out[x + i], band, sums[i]);
    }
  return PL_OK;
}

/* Convolves directly with a kernel of the given half widths. `spread`: as for pl_psf_kernel. */
static pl_status spread_direct(pl_sensor_frame *frame, int reach_x, int reach_y, bool spread) {
  const size_t pixels = (size_t)frame->width * (size_t)frame->height;
  const size_t taps = (2 * (size_t)reach_x + 1) * (2 * (size_t)reach_y + 1);
  direct d = {.frame = frame, .reach = {reach_x, reach_y}};
  for (int band = 0; band < 3; band++) {
    d.kernels[band] = pl_arena_alloc(frame->arena, taps, sizeof(double));
    d.light[band] = pl_arena_alloc(frame->arena, pixels, sizeof(double));
    if (d.kernels[band] == NULL || d.light[band] == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for a point-spread function");
    pl_psf_kernel(frame->sensor, band, reach_x, reach_y, spread, d.kernels[band]);
    for (size_t i = 0; i < pixels; i++)
      d.light[band][i] = band_of(frame, i, band);
  }
  return pl_parallel_for(frame->threads, (size_t)frame->height, direct_row, &d, frame->cancel);
}

/* --- whole function, by Fourier transforms */

typedef struct whole {
  pl_plane plane;
  int reach[2];
  pl_complex *kernel, *image;
  double *parts;
} whole;

/* Required half width of the kernel. Analytic functions: half the image, beyond which little energy
 * remains. Measured functions: their full size. */
static void least_reach(const pl_psf *psf, int width, int height, int reach[2]) {
  const bool measured = psf->core == PL_PSF_MEASURED, endless = !measured || psf->wings > 0.0;
  const int sides[2] = {width, height}, kernel[2] = {psf->kernel_width, psf->kernel_height};
  for (int k = 0; k < 2; k++) {
    reach[k] = endless ? (sides[k] + 1) / 2 : 0;
    if (measured && kernel[k] / 2 > reach[k])
      reach[k] = kernel[k] / 2;
    if (measured && reach[k] > sides[k] - 1)
      reach[k] = sides[k] - 1;
  }
}

static pl_status whole_init(whole *w, const pl_sensor_frame *frame) {
  least_reach(&frame->sensor->psf, frame->width, frame->height, w->reach);
  PL_TRY(pl_plane_init(&w->plane, frame->width, frame->height, frame->threads, frame->cancel,
                       frame->arena, w->reach));
  const size_t parts = (2 * (size_t)w->reach[0] + 1) * (2 * (size_t)w->reach[1] + 1);
  w->kernel = pl_plane_alloc(&w->plane, frame->arena);
  w->image = pl_plane_alloc(&w->plane, frame->arena);
  w->parts = pl_arena_alloc(frame->arena, parts, sizeof(double));
  if (w->kernel == NULL || w->image == NULL || w->parts == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for a point-spread function");
  return PL_OK;
}

static pl_status load_kernel(whole *w, const pl_sensor *sensor, int band) {
  const pl_plane *p = &w->plane;
  const size_t columns = 2 * (size_t)w->reach[0] + 1, rows = 2 * (size_t)w->reach[1] + 1;
  pl_psf_kernel(sensor, band, w->reach[0], w->reach[1], true, w->parts);
  memset(w->kernel, 0, p->width * p->height * sizeof *w->kernel);
  for (size_t v = 0; v < rows; v++)
    for (size_t u = 0; u < columns; u++) {
      const size_t x = (u + p->width - (size_t)w->reach[0]) % p->width;
      const size_t y = (v + p->height - (size_t)w->reach[1]) % p->height;
      w->kernel[y * p->width + x].re = w->parts[v * columns + u];
    }
  return pl_plane_spectrum(p, w->kernel);
}

/* Convolves two bands at once, one as the real and one as the imaginary part; `second` may be -1.
 */
static pl_status spread_bands(whole *w, pl_sensor_frame *frame, int first, int second) {
  const size_t width = (size_t)frame->width, height = (size_t)frame->height;
  memset(w->image, 0, w->plane.width * w->plane.height * sizeof *w->image);
  for (size_t y = 0; y < height; y++)
    for (size_t x = 0; x < width; x++) {
      pl_complex *at = &w->image[y * w->plane.width + x];
      at->re = band_of(frame, y * width + x, first);
      at->im = second >= 0 ? band_of(frame, y * width + x, second) : 0.0;
    }
  PL_TRY(pl_plane_convolve(&w->plane, w->image, w->kernel));
  for (size_t y = 0; y < height; y++)
    for (size_t x = 0; x < width; x++) {
      const pl_complex at = w->image[y * w->plane.width + x];
      set_band(&frame->bands[y * width + x], first, at.re);
      if (second >= 0)
        set_band(&frame->bands[y * width + x], second, at.im);
    }
  return PL_OK;
}

/* Costs in nanoseconds per pixel for three bands, measured at 640 x 480 by process time: Fourier
 * transforms (with one kernel or three), and direct convolution. */
static double transform_ns(const pl_psf *psf, int width, int height) {
  int reach[2];
  least_reach(psf, width, height, reach);
  const double count =
      (double)pl_plane_side(width, reach[0]) * (double)pl_plane_side(height, reach[1]);
  return (psf->core == PL_PSF_AIRY ? 14.0 : 6.5) * count / width / height * log2(count + 1.0);
}

static double direct_ns(int reach_x, int reach_y) {
  return 1.1 * (2.0 * reach_x + 1.0) * (2.0 * reach_y + 1.0);
}

/* True if direct convolution with the whole function is cheaper than Fourier transforms. */
static bool is_small(const pl_psf *psf, int width, int height, int reach[2]) {
  least_reach(psf, width, height, reach);
  return psf->core == PL_PSF_MEASURED && psf->wings == 0.0 &&
         direct_ns(reach[0], reach[1]) <= transform_ns(psf, width, height);
}

static pl_status spread_whole(pl_sensor_frame *frame) {
  whole w;
  if (is_small(&frame->sensor->psf, frame->width, frame->height, w.reach))
    return spread_direct(frame, w.reach[0], w.reach[1], true);
  PL_TRY(whole_init(&w, frame));
  PL_TRY(load_kernel(&w, frame->sensor, 0));
  if (frame->sensor->psf.core != PL_PSF_AIRY) { /* the same kernel for all bands */
    PL_TRY(spread_bands(&w, frame, 0, 1));
    return spread_bands(&w, frame, 2, -1);
  }
  for (int band = 0; band < 3; band++) {
    if (band > 0)
      PL_TRY(load_kernel(&w, frame->sensor, band));
    PL_TRY(spread_bands(&w, frame, band, -1));
  }
  return PL_OK;
}

pl_status pl_stage_point_spread(pl_sensor_frame *frame, int value) {
  return value > 1 ? spread_whole(frame) : spread_direct(frame, REACH, REACH, false);
}

/* --- effect row */

static const char *absent(const pl_view *view) {
  const char *none = pl_sensor_absent(view);
  if (none != NULL)
    return none;
  const pl_psf *psf = &view->sensor->psf;
  return psf->core == PL_PSF_POINT && psf->wings == 0.0 ? "the lens images points without blur"
                                                        : NULL;
}

static int ceiling(const pl_view *view) {
  (void)view;
  return 2;
}

/* The central part ignores energy that falls outside it: at most that fraction of the brightest
 * light. In an image smaller than the central part, the whole function is the one that has to put
 * this energy elsewhere. */
static double bound_dn(const pl_view *view, int value) {
  double outside = 1.0;
  if (value > 1)
    return 0.0;
  int reach[2];
  least_reach(&view->sensor->psf, view->width, view->height, reach);
  const int whole =
      (int)fmin(pl_plane_reach(view->width, reach[0]), pl_plane_reach(view->height, reach[1]));
  for (int band = 0; value == 1 && band < 3; band++) {
    const double part = pl_psf_outside(view->sensor, band, fmin(REACH, whole) + 0.5);
    outside = band == 0 ? part : fmax(outside, part);
  }
  return outside > 0.0 ? pl_sensor_light_dn(view, outside * pl_sensor_electrons_max(view)) : 0.0;
}

static double cost_ms(const pl_view *view, int value) {
  int reach[2];
  const pl_psf *psf = &view->sensor->psf;
  if (value == 1)
    return pl_sensor_cost_ms(view, direct_ns(REACH, REACH));
  if (value > 1 && is_small(psf, view->width, view->height, reach))
    return pl_sensor_cost_ms(view, direct_ns(reach[0], reach[1]));
  return pl_sensor_cost_ms(view, value > 1 ? transform_ns(psf, view->width, view->height) : 0.0);
}

const pl_effect pl_effect_point_spread = {
    .name = "point_spread",
    .doc = "Sensor: blur and glare of the lens; 1: core of the point-spread function, 2: core "
           "and wings",
    .absent = absent,
    .ceiling = ceiling,
    .bound_dn = bound_dn,
    .cost_ms = cost_ms,
};
