/* Validation of a sensor, and quantities derived from its parameters. */
#include "sensor/sensor.h"

#include <math.h>
#include <string.h>

/* CODATA 2018, exact */
static const double PLANCK_J_S = 6.62607015e-34, LIGHT_M_S = 299792458.0;
static const double PI = 3.14159265358979323846;

static pl_status in_range(const char *what, double value, double low, double high) {
  if (!(value >= low && value <= high))
    return pl_fail(PL_E_RANGE, "sensor: %s must be in %g..%g, not %g", what, low, high, value);
  return PL_OK;
}

static pl_status check_mix(const pl_sensor *sensor) {
  for (int band = 0; band < 3 && sensor->mixed; band++) {
    double sum = 0.0;
    for (int c = 0; c < 3; c++) {
      PL_TRY(in_range("mix", sensor->mix[band][c], 0.0, 1.0));
      sum += sensor->mix[band][c];
    }
    PL_TRY(in_range("sum of a row of mix", sum, 1.0 - 1e-9, 1.0 + 1e-9));
  }
  if (sensor->mixed && sensor->mosaic == PL_MOSAIC_MONO)
    return pl_fail(PL_E_ARGUMENT, "sensor: mix without filters");
  return PL_OK;
}

static pl_status check_planes(const pl_sensor *sensor) {
  for (size_t i = 0; i < sensor->plane_count; i++)
    for (int c = 0; c < 3; c++) {
      PL_TRY(in_range("band_share of a plane", sensor->planes[i].band_share[c], 0.0, 1.0));
      PL_TRY(in_range("wavelength of a plane", sensor->planes[i].wavelength_m[c], 1e-8, 1e-4));
    }
  if (sensor->plane_count > 0 && sensor->mosaic != PL_MOSAIC_MONO)
    return pl_fail(PL_E_ARGUMENT, "sensor: planes behind a mosaic of filters");
  return PL_OK;
}

static pl_status check_bands(const pl_sensor *sensor) {
  for (int band = 0; band < 3; band++) {
    PL_TRY(in_range("quantum_efficiency", sensor->quantum_efficiency[band], 0.0, 1.0));
    PL_TRY(in_range("band_share", sensor->band_share[band], 0.0, 1.0));
    PL_TRY(in_range("wavelength", sensor->wavelength_m[band], 1e-8, 1e-4));
  }
  PL_TRY(check_mix(sensor));
  PL_TRY(check_planes(sensor));
  if (!(pl_sensor_response_white(sensor) > 0.0) && sensor->exposure_s > 0.0)
    return pl_fail(PL_E_RANGE, "sensor: no band has a response");
  return PL_OK;
}

static pl_status check_auto_time(const pl_auto_time *auto_time) {
  if (!auto_time->on)
    return PL_OK;
  PL_TRY(in_range("percentile", auto_time->percentile, 0.0, 100.0));
  PL_TRY(in_range("key", auto_time->key, 1e-6, 1.0));
  PL_TRY(in_range("min_s", auto_time->min_s, 1e-12, 1e9));
  PL_TRY(in_range("max_s", auto_time->max_s, auto_time->min_s, 1e9));
  PL_TRY(in_range("saturated", auto_time->saturated, 0.0, 1.0));
  for (int k = 0; k < 2; k++) {
    PL_TRY(in_range("window", auto_time->window[k], 0.0, 1.0));
    PL_TRY(in_range("window", auto_time->window[k + 2], auto_time->window[k], 1.0));
  }
  PL_TRY(in_range("number of times", auto_time->time_count, 0.0, PL_AUTO_TIMES));
  for (int i = 0; i < auto_time->time_count; i++)
    PL_TRY(
        in_range("times", auto_time->times_s[i], i > 0 ? auto_time->times_s[i - 1] : 1e-12, 1e9));
  PL_TRY(in_range("number of gains", auto_time->gain_count, 0.0, PL_AUTO_GAINS));
  for (int i = 0; i < auto_time->gain_count; i++)
    PL_TRY(in_range("gains", auto_time->gains[i], i > 0 ? auto_time->gains[i - 1] : 1e-3, 1e3));
  return in_range("step_s", auto_time->step_s, 0.0, 1e9);
}

static pl_status check_kernel(const pl_psf *psf) {
  double sum = 0.0;
  if (psf->kernel == NULL || psf->kernel_width < 1 || psf->kernel_height < 1)
    return pl_fail(PL_E_RANGE, "sensor: point spread: a measured core needs a kernel");
  for (size_t i = 0; i < (size_t)psf->kernel_width * (size_t)psf->kernel_height; i++) {
    PL_TRY(in_range("point spread: kernel", psf->kernel[i], 0.0, 1.0 + 1e-9));
    sum += psf->kernel[i];
  }
  return in_range("point spread: sum of the kernel", sum, 1.0 - 1e-6, 1.0 + 1e-6);
}

static pl_status check_psf(const pl_psf *psf) {
  PL_TRY(in_range("point spread: core", psf->core, 0, PL_PSF_CORES - 1));
  if (psf->core == PL_PSF_GAUSS)
    PL_TRY(in_range("point spread: sigma", psf->sigma_px, 1e-3, 1e4));
  if (psf->core == PL_PSF_MEASURED)
    PL_TRY(check_kernel(psf));
  PL_TRY(in_range("point spread: wings", psf->wings, 0.0, 1.0));
  if (psf->wings == 0.0)
    return PL_OK;
  PL_TRY(in_range("point spread: wing radius", psf->wing_radius_px, 1e-3, 1e4));
  return in_range("point spread: wing beta", psf->wing_beta, 1.001, 100.0);
}

pl_status pl_sensor_check(const pl_sensor *sensor) {
  const double most = (double)((1u << sensor->bits % 32) - 1u);
  PL_TRY(in_range("bits", sensor->bits, 1.0, 16.0));
  PL_TRY(in_range("f_number", sensor->f_number, 0.5, 1e6));
  PL_TRY(in_range("transmission", sensor->transmission, 0.0, 1.0));
  PL_TRY(in_range("pixel", sensor->pixel_m, 1e-8, 1.0));
  PL_TRY(in_range("exposure time", sensor->exposure_s, 0.0, 1e12));
  PL_TRY(in_range("prnu", sensor->prnu, 0.0, 1.0));
  PL_TRY(in_range("dark_current", sensor->dark_current, 0.0, 1e12));
  PL_TRY(in_range("dark_nonuniform", sensor->dark_nonuniform, 0.0, 100.0));
  PL_TRY(in_range("hot_pixels", sensor->hot_pixels, 0.0, 1.0));
  PL_TRY(in_range("hot_current", sensor->hot_current, 0.0, 1e12));
  PL_TRY(in_range("dead_pixels", sensor->dead_pixels, 0.0, 1.0));
  PL_TRY(in_range("shift", sensor->shift_s, 0.0, 1e6));
  PL_TRY(in_range("drain", sensor->drain, 0.0, 1.0));
  PL_TRY(in_range("ray_flux", sensor->ray_flux, 0.0, 1e15));
  PL_TRY(in_range("ray_electrons_per_m", sensor->ray_electrons_per_m, 0.0, 1e15));
  PL_TRY(in_range("ray_depth", sensor->ray_depth_m, 0.0, 1.0));
  PL_TRY(in_range("full_well", sensor->full_well, 1.0, 1e12));
  PL_TRY(in_range("read_noise", sensor->read_noise, 0.0, 1e9));
  PL_TRY(in_range("column_noise", sensor->column_noise, 0.0, 1e9));
  PL_TRY(in_range("column_flicker", sensor->column_flicker, 0.0, 1e9));
  PL_TRY(in_range("row_noise", sensor->row_noise, 0.0, 1e9));
  PL_TRY(in_range("compression: quality", sensor->compression.quality, 0.0, 100.0));
  PL_TRY(in_range("compression: chroma", sensor->compression.chroma, 0, PL_CHROMAS - 1));
  PL_TRY(in_range("reset", sensor->reset_s, 0.0, 1e6));
  PL_TRY(in_range("gain", sensor->gain, 1e-9, 1e9));
  PL_TRY(in_range("black_level", sensor->black_level, 0.0, most - 1.0));
  PL_TRY(in_range("mosaic", sensor->mosaic, 0, PL_MOSAIC_COUNT - 1));
  PL_TRY(check_psf(&sensor->psf));
  PL_TRY(pl_shading_check(&sensor->shading));
  PL_TRY(pl_flare_check(&sensor->flare));
  PL_TRY(check_bands(sensor));
  return check_auto_time(&sensor->auto_time);
}

/* Irradiance on the axis for a radiance of 1: pi sin^2 of the marginal ray's angle. The sine is 1 /
 * (2 N) by the sine condition, which lenses without coma fulfil (Born and Wolf, Principles of
 * Optics, 4.5.1). Through a flat aperture the tangent is 1 / (2 N). */
static double axis_irradiance(const pl_sensor *s) {
  const double square = 4.0 * s->f_number * s->f_number;
  return PI * s->transmission / (s->plane_pupil ? square + 1.0 : square);
}

/* pl_sensor_response for an exposure of one second. */
static double response_rate(const pl_sensor *s, int band) {
  const double irradiance = axis_irradiance(s);
  const double photons_a_joule = s->wavelength_m[band] / (PLANCK_J_S * LIGHT_M_S);
  return irradiance * s->pixel_m * s->pixel_m * s->band_share[band] * s->quantum_efficiency[band] *
         photons_a_joule;
}

static double response_rate_white(const pl_sensor *s) {
  const double r = response_rate(s, 0), g = response_rate(s, 1), b = response_rate(s, 2);
  return s->mosaic == PL_MOSAIC_MONO ? r + g + b : fmax(r, fmax(g, b));
}

double pl_sensor_response(const pl_sensor *sensor, int band) {
  return sensor->exposure_s * response_rate(sensor, band);
}

double pl_sensor_response_white(const pl_sensor *sensor) {
  return sensor->exposure_s * response_rate_white(sensor);
}

double pl_sensor_white_electrons(const pl_sensor *sensor) {
  const double most = (double)((1u << sensor->bits) - 1u);
  return fmin(sensor->full_well, (most - sensor->black_level) * sensor->gain);
}

double pl_sensor_full_radiance(const pl_sensor *sensor) {
  return pl_sensor_white_electrons(sensor) / pl_sensor_response_white(sensor);
}

pl_sensor pl_sensor_of_plane(const pl_sensor *sensor, size_t plane) {
  pl_sensor out = *sensor;
  memcpy(out.band_share, sensor->planes[plane].band_share, sizeof out.band_share);
  memcpy(out.wavelength_m, sensor->planes[plane].wavelength_m, sizeof out.wavelength_m);
  out.plane_count = 0;
  return out;
}

double pl_sensor_balance(const pl_sensor *sensor, int band) {
  const double response = pl_sensor_response(sensor, band);
  const bool balanced = sensor->mosaic != PL_MOSAIC_MONO && response > 0.0;
  return balanced ? pl_sensor_response_white(sensor) / response : 1.0;
}

double pl_sensor_read_deviation(const pl_sensor *sensor) {
  return sensor->read_noise + sensor->column_noise + sensor->column_flicker + sensor->row_noise;
}

int pl_sensor_band(pl_mosaic mosaic, int x, int y) {
  static const int bands[PL_MOSAIC_COUNT][4] = {
      {1, 1, 1, 1}, {0, 1, 1, 2}, {2, 1, 1, 0}, {1, 0, 2, 1}, {1, 2, 0, 1}};
  return bands[mosaic][2 * (y & 1) + (x & 1)];
}
