/* Reading the sensor of a request. */
#include "pyext/py_read.h"
#include "pyext/py_request.h"

static const char WHERE[] = "sensor";

/* A number of the mapping and where it goes. */
typedef struct number {
  const char *key;
  double *out;
} number;

static int parse_numbers(PyObject *dict, const number *numbers, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (pl_py_member_double(dict, numbers[i].key, WHERE, numbers[i].out) < 0)
      return -1;
  return 0;
}

static int parse_psf(PyObject *dict, pl_psf *out) {
  static const char *const cores[PL_PSF_CORES] = {"point", "gauss", "airy"};
  const number numbers[] = {{"sigma_px", &out->sigma_px},
                            {"wings", &out->wings},
                            {"wing_radius_px", &out->wing_radius_px},
                            {"wing_beta", &out->wing_beta}};
  PyObject *given;
  if (pl_py_member(dict, "psf", 0, WHERE, &given) < 0)
    return -1;
  const int core = pl_py_member_choice(given, "core", WHERE, cores, PL_PSF_CORES);
  const int failed = parse_numbers(given, numbers, sizeof numbers / sizeof numbers[0]);
  Py_DECREF(given);
  out->core = (pl_psf_core)core;
  return core < 0 ? -1 : failed;
}

static int parse_pixels(PyObject *dict, pl_sensor *out) {
  static const char *const mosaics[PL_MOSAIC_COUNT] = {"mono", "rggb", "bggr", "grbg", "gbrg"};
  size_t serial, bits;
  const int mosaic = pl_py_member_choice(dict, "mosaic", WHERE, mosaics, PL_MOSAIC_COUNT);
  if (mosaic < 0 || pl_py_member_size(dict, "serial", WHERE, &serial) < 0 ||
      pl_py_member_size(dict, "bits", WHERE, &bits) < 0 ||
      pl_py_member_doubles(dict, "quantum_efficiency", WHERE, 3, out->quantum_efficiency) < 0 ||
      pl_py_member_doubles(dict, "band_share", WHERE, 3, out->band_share) < 0 ||
      pl_py_member_doubles(dict, "wavelength_m", WHERE, 3, out->wavelength_m) < 0)
    return -1;
  out->mosaic = (pl_mosaic)mosaic;
  out->serial = serial;
  out->bits = bits <= 64 ? (int)bits : 64; /* pl_sensor_check refuses it */
  return 0;
}

/* "auto_time": None for a fixed exposure time. */
static int parse_auto_time(PyObject *dict, pl_auto_time *out) {
  PyObject *given;
  if (pl_py_member(dict, "auto_time", 1, WHERE, &given) < 0)
    return -1;
  const number numbers[] = {{"percentile", &out->percentile},
                            {"key", &out->key},
                            {"min_s", &out->min_s},
                            {"max_s", &out->max_s},
                            {"step_s", &out->step_s}};
  out->on = given != Py_None;
  const int failed =
      out->on ? parse_numbers(given, numbers, sizeof numbers / sizeof numbers[0]) : 0;
  Py_DECREF(given);
  return failed;
}

static int parse(PyObject *dict, pl_sensor *out) {
  const number numbers[] = {{"f_number", &out->f_number},
                            {"transmission", &out->transmission},
                            {"pixel_m", &out->pixel_m},
                            {"exposure_s", &out->exposure_s},
                            {"prnu", &out->prnu},
                            {"dark_current", &out->dark_current},
                            {"dark_nonuniform", &out->dark_nonuniform},
                            {"vignetting", &out->vignetting},
                            {"hot_pixels", &out->hot_pixels},
                            {"hot_current", &out->hot_current},
                            {"dead_pixels", &out->dead_pixels},
                            {"shift_s", &out->shift_s},
                            {"drain", &out->drain},
                            {"ray_flux", &out->ray_flux},
                            {"ray_electrons_per_m", &out->ray_electrons_per_m},
                            {"ray_depth_m", &out->ray_depth_m},
                            {"full_well", &out->full_well},
                            {"read_noise", &out->read_noise},
                            {"column_noise", &out->column_noise},
                            {"gain", &out->gain},
                            {"black_level", &out->black_level}};
  *out = (pl_sensor){0};
  if (parse_numbers(dict, numbers, sizeof numbers / sizeof numbers[0]) < 0 ||
      parse_psf(dict, &out->psf) < 0 || parse_pixels(dict, out) < 0)
    return -1;
  return parse_auto_time(dict, &out->auto_time);
}

int pl_py_sensor_parse(PyObject *request, pl_py_states *states, pl_frame_request *out) {
  PyObject *given;
  if (pl_py_member(request, "sensor", 1, "request", &given) < 0)
    return -1;
  const int failed = given != Py_None ? parse(given, &states->sensor) : 0;
  out->sensor = given != Py_None ? &states->sensor : NULL;
  Py_DECREF(given);
  return failed;
}
