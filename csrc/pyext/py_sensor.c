/* Parses the sensor of a request. */
#include "pyext/py_read.h"
#include "pyext/py_request.h"
#include "pyext/py_types.h"

static const char WHERE[] = "sensor";

/* A key of the mapping and the address of its value. */
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
  static const char *const cores[PL_PSF_CORES] = {"point", "gauss", "airy", "measured"};
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
  out->bits = bits <= 64 ? (int)bits : 64; /* pl_sensor_check rejects it */
  return 0;
}

/* "vignetting_profile" (points, 2), angle and factor: absent or None for none. */
static int parse_profile(PyObject *dict, pl_shading *out) {
  PyObject *given;
  if (pl_py_member(dict, "vignetting_profile", 1, WHERE, &given) < 0)
    return -1;
  Py_DECREF(given);
  if (given == Py_None)
    return 0;
  const npy_intp shape[2] = {-1, 2};
  PyArrayObject *points = pl_py_member_array(dict, "vignetting_profile", WHERE, 2, shape);
  if (points == NULL)
    return -1;
  const npy_intp count = PyArray_DIM(points, 0);
  const double *p = PyArray_DATA(points);
  out->count = count <= PL_SHADING_POINTS ? (int)count : PL_SHADING_POINTS + 1;
  for (int i = 0; i < out->count && i < PL_SHADING_POINTS; i++) {
    out->angle_rad[i] = p[2 * i];
    out->factor[i] = p[2 * i + 1];
  }
  Py_DECREF((PyObject *)points);
  return 0;
}

/* Image of the mapping, borrowed from an array that the frame keeps alive. */
typedef struct sensor_image {
  void *pixels; /* NULL when there is none */
  int width, height;
} sensor_image;

/* Borrows an array without a copy: a flat field is as large as the image. */
static int lend(PyArrayObject *array, const char *key, PyObject *kept, sensor_image *out) {
  if (pl_py_keep_memory(kept, (PyObject *)array) < 0)
    return -1;
  if (PyArray_NDIM(array) != 2) {
    PyErr_Format(PyExc_ValueError, "%s: %s must have 2 dimensions, not %d", WHERE, key,
                 PyArray_NDIM(array));
    return -1;
  }
  if (PyArray_SIZE(array) == 0 || PyArray_DIM(array, 0) > INT_MAX ||
      PyArray_DIM(array, 1) > INT_MAX) {
    PyErr_Format(PyExc_ValueError, "%s: %s has no pixels, or too many", WHERE, key);
    return -1;
  }
  *out =
      (sensor_image){PyArray_DATA(array), (int)PyArray_DIM(array, 1), (int)PyArray_DIM(array, 0)};
  return 0;
}

/* The key may be absent or None. */
static int image_of(PyObject *dict, const char *key, int type, PyObject *kept, sensor_image *out) {
  PyObject *given;
  *out = (sensor_image){0};
  if (pl_py_member(dict, key, 1, WHERE, &given) < 0)
    return -1;
  const bool there = given != Py_None;
  PyArrayObject *array =
      there ? (PyArrayObject *)PyArray_FROMANY(given, type, 0, 0, NPY_ARRAY_IN_ARRAY) : NULL;
  Py_DECREF(given);
  const int failed = array != NULL ? lend(array, key, kept, out) : 0;
  Py_XDECREF((PyObject *)array);
  return there && array == NULL ? -1 : failed;
}

/* "kernel" (any height, any width), a measured point-spread function: may be absent or None. */
static int parse_kernel(PyObject *dict, pl_py_states *states) {
  sensor_image kernel;
  if (image_of(dict, "kernel", NPY_DOUBLE, states->kept, &kernel) < 0)
    return -1;
  states->sensor.psf.kernel = kernel.pixels;
  states->sensor.psf.kernel_width = kernel.width;
  states->sensor.psf.kernel_height = kernel.height;
  return 0;
}

/* "lens_flare": {"baffle_rad": (2,), "ghosts": (ghosts, 5): scale, radius, red, green, blue}; may
 * be absent or None. */
static int parse_flare(PyObject *dict, pl_flare *out) {
  PyObject *given;
  if (pl_py_member(dict, "lens_flare", 1, WHERE, &given) < 0)
    return -1;
  const npy_intp shape[2] = {-1, 5};
  PyArrayObject *ghosts = NULL;
  const int failed = given != Py_None &&
                     (pl_py_member_doubles(given, "baffle_rad", WHERE, 2, out->baffle_rad) < 0 ||
                      !(ghosts = pl_py_member_array(given, "ghosts", WHERE, 2, shape)));
  Py_DECREF(given);
  const npy_intp count = ghosts != NULL ? PyArray_DIM(ghosts, 0) : 0;
  const double *g = ghosts != NULL ? PyArray_DATA(ghosts) : NULL;
  out->count = count <= PL_GHOSTS_MAX ? (int)count : PL_GHOSTS_MAX + 1;
  for (int i = 0; i < out->count && i < PL_GHOSTS_MAX; i++, g += 5)
    out->ghosts[i] = (pl_ghost){g[0], g[1], {g[2], g[3], g[4]}};
  Py_XDECREF((PyObject *)ghosts);
  return failed ? -1 : 0;
}

/* "compression": {"quality", "chroma"}; may be absent or None. */
static int parse_compression(PyObject *dict, pl_compression *out) {
  static const char *const chromas[PL_CHROMAS] = {"444", "422", "420"};
  PyObject *given;
  if (pl_py_member(dict, "compression", 1, WHERE, &given) < 0)
    return -1;
  size_t quality = 0;
  int chroma = 0, failed = 0;
  if (given != Py_None) {
    failed = pl_py_member_size(given, "quality", WHERE, &quality);
    chroma = failed ? -1 : pl_py_member_choice(given, "chroma", WHERE, chromas, PL_CHROMAS);
  }
  Py_DECREF(given);
  out->quality = quality <= 100 ? (int)quality : 101; /* pl_sensor_check rejects it */
  out->chroma = (pl_chroma)chroma;
  return failed < 0 || chroma < 0 ? -1 : 0;
}

/* "flat_field" (any height, any width) float32: may be absent or None. */
static int parse_flat(PyObject *dict, pl_py_states *states) {
  sensor_image flat;
  if (image_of(dict, "flat_field", NPY_FLOAT, states->kept, &flat) < 0)
    return -1;
  if (flat.pixels == NULL)
    return 0;
  const pl_status status =
      pl_shading_set_flat(&states->sensor.shading, flat.pixels, flat.width, flat.height);
  return status == PL_OK ? 0 : (pl_py_raise(status), -1);
}

/* "plane_pupil": optional, default false. */
static int parse_pupil(PyObject *dict, pl_sensor *out) {
  PyObject *given;
  if (pl_py_member(dict, "plane_pupil", 1, WHERE, &given) < 0)
    return -1;
  out->plane_pupil = given == Py_True;
  Py_DECREF(given);
  return 0;
}

/* Reads up to `room` numbers of an optional sequence. *count is room + 1 for longer ones, which
 * pl_sensor_check rejects. */
static int parse_list(PyObject *dict, const char *key, int room, double *out, int *count) {
  PyObject *given;
  if (pl_py_member(dict, key, 1, WHERE, &given) < 0)
    return -1;
  PyArrayObject *numbers = given != Py_None ? pl_py_doubles(given, key) : NULL;
  const int failed = given != Py_None && numbers == NULL;
  Py_DECREF(given);
  const npy_intp size = numbers != NULL ? PyArray_SIZE(numbers) : 0;
  *count = size <= room ? (int)size : room + 1;
  for (int i = 0; i < *count && i < room; i++)
    out[i] = ((const double *)PyArray_DATA(numbers))[i];
  Py_XDECREF((PyObject *)numbers);
  return failed ? pl_py_prefix_error(WHERE) : 0;
}

/* "auto_time": None for a fixed exposure time. */
static int parse_auto_time(PyObject *dict, pl_auto_time *out) {
  static const char *const ways[] = {"percentile", "mean"};
  PyObject *given;
  if (pl_py_member(dict, "auto_time", 1, WHERE, &given) < 0)
    return -1;
  const number numbers[] = {{"percentile", &out->percentile}, {"key", &out->key},
                            {"saturated", &out->saturated},   {"min_s", &out->min_s},
                            {"max_s", &out->max_s},           {"step_s", &out->step_s}};
  out->on = given != Py_None;
  int failed = out->on ? parse_numbers(given, numbers, sizeof numbers / sizeof numbers[0]) : 0;
  if (out->on && failed == 0) {
    const int way = pl_py_member_choice(given, "metering", WHERE, ways, 2);
    out->mean = way == 1;
    failed = way < 0 || pl_py_member_doubles(given, "window", WHERE, 4, out->window) < 0 ||
             parse_list(given, "times_s", PL_AUTO_TIMES, out->times_s, &out->time_count) < 0 ||
             parse_list(given, "gains", PL_AUTO_GAINS, out->gains, &out->gain_count) < 0;
  }
  Py_DECREF(given);
  return failed ? -1 : 0;
}

static int parse(PyObject *dict, pl_py_states *states) {
  pl_sensor *out = &states->sensor;
  const number numbers[] = {{"f_number", &out->f_number},
                            {"transmission", &out->transmission},
                            {"pixel_m", &out->pixel_m},
                            {"exposure_s", &out->exposure_s},
                            {"prnu", &out->prnu},
                            {"dark_current", &out->dark_current},
                            {"dark_nonuniform", &out->dark_nonuniform},
                            {"vignetting", &out->shading.power},
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
  const number optional[] = {{"column_flicker", &out->column_flicker},
                             {"row_noise", &out->row_noise},
                             {"reset_s", &out->reset_s}};
  *out = (pl_sensor){0};
  for (size_t i = 0; i < sizeof optional / sizeof optional[0]; i++)
    if (pl_py_optional_double(dict, optional[i].key, WHERE, optional[i].out) < 0)
      return -1;
  if (parse_numbers(dict, numbers, sizeof numbers / sizeof numbers[0]) < 0 ||
      parse_psf(dict, &out->psf) < 0 || parse_pixels(dict, out) < 0 || parse_pupil(dict, out) < 0 ||
      pl_py_filters_parse(dict, states, out) < 0 || parse_profile(dict, &out->shading) < 0 ||
      parse_flat(dict, states) < 0 || parse_kernel(dict, states) < 0 ||
      parse_flare(dict, &out->flare) < 0 || parse_compression(dict, &out->compression) < 0)
    return -1;
  return parse_auto_time(dict, &out->auto_time);
}

int pl_py_sensor_parse(PyObject *request, pl_py_states *states, pl_frame_request *out) {
  PyObject *given;
  if (pl_py_member(request, "sensor", 1, "request", &given) < 0)
    return -1;
  const int failed = given != Py_None ? parse(given, states) : 0;
  out->sensor = given != Py_None ? &states->sensor : NULL;
  Py_DECREF(given);
  return failed;
}
