/* Point-spread functions: a Gaussian, Airy or measured core with Moffat wings, (1 - w) core + w
 * wings. */
#include "sensor/psf.h"

#include <math.h>
#include <stdlib.h>

static const double PI = 3.14159265358979323846;
/* Within this many pixels of the centre the function is averaged over SAMPLES^2 points per pixel.
 * Farther out it is smooth, except for the rings of the Airy pattern, which are averaged by a
 * formula. */
static const double NEAR_PX = 24.0;
enum { SAMPLES = 16 };

/* Scale of the Airy pattern: x = pi r / (lambda N), r in pixels. */
static double airy_scale(const pl_sensor *s, int band) {
  return PI * s->pixel_m / (s->wavelength_m[band] * s->f_number);
}

/* Energy density of the Airy pattern at r, per pixel area, for a total of 1 (Born and Wolf,
 * Principles of Optics, 8.5.2: the density is k^2 / (4 pi) [2 J1(x) / x]^2). */
static double airy(double k, double r) {
  const double x = k * r;
  const double amplitude = x > 1e-6 ? 2.0 * j1(x) / x : 1.0;
  return k * k / (4.0 * PI) * amplitude * amplitude;
}

/* Mean of the Airy pattern over one ring: J1(x)^2 is 1 / (pi x) on average. */
static double airy_far(double k, double r) { return 1.0 / (PI * PI * k * r * r * r); }

/* Moffat profile (Moffat 1969): (b - 1) / (pi a^2) (1 + r^2 / a^2)^-b */
static double wings(const pl_psf *psf, double r) {
  const double a = psf->wing_radius_px, b = psf->wing_beta;
  return (b - 1.0) / (PI * a * a) * pow(1.0 + r * r / (a * a), -b);
}

/* Energy of a measured kernel outside a box around its central pixel. */
static double kernel_outside(const pl_psf *psf, double reach_x, double reach_y) {
  double sum = 0.0;
  for (int v = 0; v < psf->kernel_height; v++)
    for (int u = 0; u < psf->kernel_width; u++)
      if (abs(u - psf->kernel_width / 2) > reach_x || abs(v - psf->kernel_height / 2) > reach_y)
        sum += psf->kernel[(size_t)v * (size_t)psf->kernel_width + (size_t)u];
  return sum;
}

double pl_psf_outside(const pl_sensor *sensor, int band, double radius_px) {
  const pl_psf *psf = &sensor->psf;
  const double r = radius_px, a = psf->wing_radius_px;
  double core = 0.0;
  if (psf->core == PL_PSF_GAUSS)
    core = exp(-0.5 * r * r / (psf->sigma_px * psf->sigma_px));
  if (psf->core == PL_PSF_AIRY) {
    const double x = airy_scale(sensor, band) * r;
    core = j0(x) * j0(x) + j1(x) * j1(x); /* Born and Wolf, 8.5.2, equation 18 */
  }
  if (psf->core == PL_PSF_MEASURED)
    core = kernel_outside(psf, r, r);
  const double tail = psf->wings > 0.0 ? pow(1.0 + r * r / (a * a), 1.0 - psf->wing_beta) : 0.0;
  return (1.0 - psf->wings) * core + psf->wings * tail;
}

/* Integral of a Gaussian over the pixel at `offset`, along one axis. */
static double gauss_pixel(double sigma, double offset) {
  const double scale = 1.0 / (sigma * sqrt(2.0));
  return 0.5 * (erf((offset + 0.5) * scale) - erf((offset - 0.5) * scale));
}

/* The wings, and the core of an Airy pattern, averaged over a pixel. */
static double sampled_pixel(const pl_sensor *sensor, double k, int x, int y) {
  const pl_psf *psf = &sensor->psf;
  const bool has_airy = psf->core == PL_PSF_AIRY;
  double core = 0.0, wing = 0.0;
  if (hypot(x, y) > NEAR_PX) {
    core = has_airy ? airy_far(k, hypot(x, y)) : 0.0;
    wing = psf->wings > 0.0 ? wings(psf, hypot(x, y)) : 0.0;
    return (1.0 - psf->wings) * core + psf->wings * wing;
  }
  for (int v = 0; v < SAMPLES; v++)
    for (int u = 0; u < SAMPLES; u++) {
      const double r = hypot(x + (u + 0.5) / SAMPLES - 0.5, y + (v + 0.5) / SAMPLES - 0.5);
      core += has_airy ? airy(k, r) : 0.0;
      wing += psf->wings > 0.0 ? wings(psf, r) : 0.0;
    }
  return ((1.0 - psf->wings) * core + psf->wings * wing) / (SAMPLES * SAMPLES);
}

static double pixel(const pl_sensor *sensor, double k, int x, int y) {
  const pl_psf *psf = &sensor->psf;
  double part = sampled_pixel(sensor, k, x, y);
  if (psf->core == PL_PSF_GAUSS)
    part += (1.0 - psf->wings) * gauss_pixel(psf->sigma_px, x) * gauss_pixel(psf->sigma_px, y);
  if (psf->core == PL_PSF_POINT && x == 0 && y == 0)
    part += 1.0 - psf->wings;
  return part;
}

static void add_measured(const pl_psf *psf, int reach_x, int reach_y, double *kernel) {
  for (int v = 0; v < psf->kernel_height; v++)
    for (int u = 0; u < psf->kernel_width; u++) {
      const int x = u - psf->kernel_width / 2 + reach_x, y = v - psf->kernel_height / 2 + reach_y;
      if (x >= 0 && y >= 0 && x <= 2 * reach_x && y <= 2 * reach_y)
        kernel[(size_t)y * (2 * (size_t)reach_x + 1) + (size_t)x] +=
            (1.0 - psf->wings) * psf->kernel[(size_t)v * (size_t)psf->kernel_width + (size_t)u];
    }
}

void pl_psf_kernel(const pl_sensor *sensor, int band, int reach_x, int reach_y, bool spread,
                   double *kernel) {
  const double k = airy_scale(sensor, band);
  const size_t width = 2 * (size_t)reach_x + 1, height = 2 * (size_t)reach_y + 1;
  const pl_psf *psf = &sensor->psf;
  double sum = 0.0, whole = 1.0;
  /* Computes one quadrant and fills all four. */
  for (int y = 0; y <= reach_y; y++)
    for (int x = 0; x <= reach_x; x++) {
      const double part = pixel(sensor, k, x, y);
      const size_t up = (size_t)(reach_y - y) * width, down = (size_t)(reach_y + y) * width;
      kernel[up + (size_t)(reach_x - x)] = kernel[up + (size_t)(reach_x + x)] = part;
      kernel[down + (size_t)(reach_x - x)] = kernel[down + (size_t)(reach_x + x)] = part;
    }
  if (psf->core == PL_PSF_MEASURED) {
    add_measured(psf, reach_x, reach_y, kernel);
    if (spread) /* the energy outside the box is known to fall there */
      whole -= (1.0 - psf->wings) * kernel_outside(psf, reach_x, reach_y);
  }
  for (size_t i = 0; i < width * height; i++)
    sum += kernel[i];
  /* A core much smaller than a pixel may fall between the sample points; the missing energy belongs
   * to the central pixel. */
  const double outside = spread ? pl_psf_outside(sensor, band, fmin(reach_x, reach_y) + 0.5) : 0.0;
  const double rest = fmin(outside, fmax(0.0, whole - sum));
  kernel[(size_t)reach_y * width + (size_t)reach_x] += whole - sum - rest;
  for (size_t i = 0; i < width * height; i++)
    kernel[i] += rest / (double)(width * height);
}
