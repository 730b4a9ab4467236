/* Methods of Renderer for sensors that trace rays of their own. */
#include "pyext/py_ray_source.h"
#include "pyext/py_read.h"
#include "pyext/py_renderer.h"
#include "pyext/py_types.h"

#include <stddef.h>
#include <string.h>

#include "base/memory.h"
#include "frame/measure.h"
#include "frame/scan.h"

/* A scan that is being made. */
typedef struct scan_call {
  pl_py_renderer *self;
  pl_frame_request request;
  pl_py_ray_source source;
  pl_scan scan;
  pl_scan_labels labels;
  pl_lidar lidar;
  pl_time_of_flight flight;
  void *out; /* records */
  size_t count;
} scan_call;

static void end(scan_call *call) {
  pl_py_ray_source_clear(&call->source);
  pl_py_renderer_end(call->self);
}

/* Reads what all scans share; 0 means that `end` must follow. */
static int begin(scan_call *call, PyObject *object, PyObject *request, PyObject *source,
                 int instants, int band) {
  call->self = (pl_py_renderer *)object;
  if (pl_py_renderer_begin(call->self) < 0)
    return -1;
  call->source = (pl_py_ray_source){.list = NULL};
  if (pl_py_request_parse(request, call->self->core, &call->self->states, &call->request) == 0 &&
      pl_py_ray_source_parse(source, &call->source) == 0) {
    call->scan = (pl_scan){.source = call->source.core, .instants = instants, .band = band};
    call->scan.source.camera = call->request.placement.camera;
    call->scan.source.shutter = call->request.placement.shutter;
    return 0;
  }
  end(call);
  return -1;
}

/* --- labels of rays --------------------------------------------------------------------------- */

static pl_status make_labels(void *context) {
  scan_call *call = context;
  return pl_renderer_trace(call->self->renderer, &call->request, &call->scan, &call->labels);
}

/* Sets the outputs of channels, which are pictures of one row. */
static int parse_channels(scan_call *call, PyObject *out, size_t count) {
  pl_frame_request picture = call->request;
  picture.placement.camera.width = (int)count;
  picture.placement.camera.height = 1;
  if (pl_py_request_outputs(out, call->self->core, call->self->states.kept, &picture) < 0)
    return -1;
  bool others = picture.rgb != NULL || picture.radiance != NULL || picture.bands != NULL ||
                picture.raw != NULL || picture.sensor_rgb != NULL || picture.glare != NULL ||
                picture.objects != NULL || picture.masks != NULL;
  for (size_t i = 0; i < pl_channel_count; i++)
    others = others || (picture.channels[i] != NULL && pl_channels[i].write == NULL);
  if (others) {
    PyErr_SetString(PyExc_ValueError, "out: only channels that a single ray fills: no colours, no "
                                      "objects, and no channels of neighbouring pixels");
    return -1;
  }
  memcpy(call->labels.channels, picture.channels, sizeof picture.channels);
  return 0;
}

static PyObject *new_array(npy_intp count, npy_intp row, int type) {
  const npy_intp shape[2] = {count, row};
  return PyArray_SimpleNew(row > 1 ? 2 : 1, shape, type);
}

static void *data_of(PyObject *array) { return PyArray_DATA((PyArrayObject *)array); }

static PyObject *trace(scan_call *call, PyObject *out, int shade) {
  const npy_intp n = (npy_intp)call->scan.source.kind->count(&call->scan.source);
  PyObject *arrays[5] = {new_array(n, 1, NPY_DOUBLE), new_array(n, 3, NPY_DOUBLE),
                         new_array(n, 3, NPY_DOUBLE), new_array(n, 3, NPY_FLOAT),
                         new_array(n, 1, NPY_FLOAT)};
  PyObject *result = NULL;
  bool made = true;
  for (int i = 0; i < 5; i++)
    made = made && arrays[i] != NULL;
  if (made && parse_channels(call, out, (size_t)n) == 0) {
    call->labels.range_m = data_of(arrays[0]);
    call->labels.origin = data_of(arrays[1]);
    call->labels.position = data_of(arrays[2]);
    call->labels.normal = data_of(arrays[3]);
    call->labels.reflectance = shade ? data_of(arrays[4]) : NULL;
    const pl_status status = pl_py_renderer_run(&call->request, make_labels, call);
    result = status != PL_OK
                 ? pl_py_raise(status)
                 : Py_BuildValue("{s:O,s:O,s:O,s:O}", "range_m", arrays[0], "origin_m", arrays[1],
                                 "position_m", arrays[2], "normal", arrays[3]);
    if (result != NULL && shade && PyDict_SetItemString(result, "reflectance", arrays[4]) < 0)
      Py_CLEAR(result);
  }
  for (int i = 0; i < 5; i++)
    Py_XDECREF(arrays[i]);
  return result;
}

PyObject *pl_py_renderer_trace(PyObject *self, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"request", "source", "out", "threads", "instants", "shade", "band", NULL};
  PyObject *request, *source, *out, *result = NULL;
  int instants = 1, shade = 0, band = 0;
  scan_call call = {.request = {.threads = 1}};
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OOO|iipi:trace", names, &request, &source, &out,
                                   &call.request.threads, &instants, &shade, &band) ||
      begin(&call, self, request, source, instants, band) < 0)
    return NULL;
  result = trace(&call, out, shade);
  end(&call);
  return result;
}

/* --- LiDAR ------------------------------------------------------------------------------------ */

static const char *const keeps[] = {"all", "first", "strongest", "last"};

static int parse_lidar(PyObject *spec, const pl_frame_request *request, pl_lidar *out) {
  const char *where = "lidar";
  size_t most = 0, stream = 0;
  const struct {
    const char *key;
    double *value;
  } members[] = {
      {"resolution_m", &out->resolution_m},
      {"min_range_m", &out->min_m},
      {"max_range_m", &out->max_m},
      {"reference_m", &out->reference_m},
      {"least_intensity", &out->least_intensity},
      {"dropout", &out->dropout},
      {"noise_m", &out->noise_m},
      {"shot_noise_m", &out->shot_noise_m},
      {"gain_noise", &out->gain_noise},
      {"ambiguity_m", &out->ambiguity_m},
  };
  for (size_t i = 0; i < sizeof members / sizeof members[0]; i++)
    if (pl_py_member_double(spec, members[i].key, where, members[i].value) < 0)
      return -1;
  const int keep = pl_py_member_choice(spec, "keep", where, keeps, PL_LIDAR_KEEPS);
  if (keep < 0 || pl_py_member_size(spec, "most", where, &most) < 0 ||
      pl_py_member_size(spec, "stream", where, &stream) < 0)
    return -1;
  out->keep = (pl_lidar_keep)keep;
  out->most = most <= PL_LIDAR_RETURNS_MAX ? (int)most : PL_LIDAR_RETURNS_MAX + 1;
  out->stream = stream;
  out->seed = request->seed;
  out->frame = request->index;
  const pl_status status = pl_lidar_check(out);
  if (status == PL_OK)
    return 0;
  pl_py_raise(status);
  return -1;
}

static pl_status make_lidar(void *context) {
  scan_call *call = context;
  return pl_renderer_lidar(call->self->renderer, &call->request, &call->scan, &call->lidar,
                           call->out, &call->count);
}

static PyObject *scan_lidar(scan_call *call) {
  const size_t beams = call->scan.source.kind->count(&call->scan.source);
  PyObject *result = NULL;
  call->out = pl_alloc(beams * (size_t)pl_lidar_slots(&call->lidar), sizeof(pl_lidar_record));
  if (call->out == NULL)
    return PyErr_NoMemory();
  const pl_status status = pl_py_renderer_run(&call->request, make_lidar, call);
  if (status == PL_OK)
    result = pl_py_records(pl_py_lidar_return(), call->out, call->count, sizeof(pl_lidar_record));
  else
    pl_py_raise(status);
  pl_free(call->out);
  return result;
}

PyObject *pl_py_renderer_lidar(PyObject *self, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"request", "source", "lidar", "threads", "instants", "band", NULL};
  PyObject *request, *source, *lidar, *result = NULL;
  int instants = 1, band = 0;
  scan_call call = {.request = {.threads = 1}};
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OOO|iii:lidar", names, &request, &source, &lidar,
                                   &call.request.threads, &instants, &band) ||
      begin(&call, self, request, source, instants, band) < 0)
    return NULL;
  if (parse_lidar(lidar, &call.request, &call.lidar) == 0)
    result = scan_lidar(&call);
  end(&call);
  return result;
}

PyObject *pl_py_lidar_return(void) {
  return Py_BuildValue(
      "[(ss),(ss),(ss),(ss(i)),(ss(i)),(ss(i)),(ss(i)),(ss),(ss),(ss),(ss),(ss),(ss),(ss),(ss(i)),"
      "(ss),(ss),(ss),(ss(i))]",
      "time_s", "<f8", "range_m", "<f8", "true_range_m", "<f8", "origin_m", "<f8", 3, "direction",
      "<f8", 3, "position_m", "<f8", 3, "sensor_direction", "<f4", 3, "intensity", "<f4",
      "reflectance", "<f4", "incidence_rad", "<f4", "beam", "<i4", "line", "<i4", "instance", "<i4",
      "part", "<i4", "semantic", "<u2", PL_LEVELS_MAX, "return_number", "<u1", "return_count",
      "<u1", "path", "<u1", "unused", "<u1", 5);
}

/* --- time of flight --------------------------------------------------------------------------- */

static int parse_flight(PyObject *spec, const pl_frame_request *request, pl_time_of_flight *out) {
  const char *where = "time_of_flight";
  const npy_intp shape[1] = {-1};
  const struct {
    const char *key;
    double *value;
  } members[] = {
      {"signal_e", &out->signal_e}, {"ambient_e", &out->ambient_e},     {"read_e", &out->read_e},
      {"contrast", &out->contrast}, {"full_well_e", &out->full_well_e}, {"least_e", &out->least_e},
  };
  for (size_t i = 0; i < sizeof members / sizeof members[0]; i++)
    if (pl_py_member_double(spec, members[i].key, where, members[i].value) < 0)
      return -1;
  PyArrayObject *list = pl_py_member_array(spec, "modulation_hz", where, 1, shape);
  if (list == NULL)
    return -1;
  const npy_intp count = PyArray_DIM(list, 0);
  out->modulations = count <= PL_MODULATIONS_MAX ? (int)count : PL_MODULATIONS_MAX + 1;
  for (npy_intp i = 0; i < count && i < PL_MODULATIONS_MAX; i++)
    out->modulation_hz[i] = ((const double *)PyArray_DATA(list))[i];
  Py_DECREF((PyObject *)list);
  out->seed = request->seed;
  out->frame = request->index;
  const pl_status status = pl_time_of_flight_check(out);
  if (status == PL_OK)
    return 0;
  pl_py_raise(status);
  return -1;
}

static pl_status make_flight(void *context) {
  scan_call *call = context;
  return pl_renderer_time_of_flight(call->self->renderer, &call->request, &call->scan,
                                    &call->flight, call->out);
}

static PyObject *take_flight(scan_call *call) {
  const size_t pixels = call->scan.source.kind->count(&call->scan.source);
  PyObject *result = NULL;
  call->out = pl_alloc(pixels, sizeof(pl_time_of_flight_pixel));
  if (call->out == NULL)
    return PyErr_NoMemory();
  const pl_status status = pl_py_renderer_run(&call->request, make_flight, call);
  if (status == PL_OK)
    result = pl_py_records(pl_py_time_of_flight_pixel(), call->out, pixels,
                           sizeof(pl_time_of_flight_pixel));
  else
    pl_py_raise(status);
  pl_free(call->out);
  return result;
}

PyObject *pl_py_renderer_time_of_flight(PyObject *self, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"request", "source", "camera", "threads", "instants", "band", NULL};
  PyObject *request, *source, *camera, *result = NULL;
  int instants = 1, band = 0;
  scan_call call = {.request = {.threads = 1}};
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OOO|iii:time_of_flight", names, &request, &source,
                                   &camera, &call.request.threads, &instants, &band) ||
      begin(&call, self, request, source, instants, band) < 0)
    return NULL;
  if (parse_flight(camera, &call.request, &call.flight) == 0)
    result = take_flight(&call);
  end(&call);
  return result;
}

PyObject *pl_py_time_of_flight_pixel(void) {
  return Py_BuildValue("[(ss),(ss),(ss),(ss),(ss),(ss),(ss(i))]", "range_m", "<f8", "true_range_m",
                       "<f8", "amplitude_e", "<f4", "offset_e", "<f4", "echoes", "<u1", "full",
                       "<u1", "unused", "<u1", 6);
}

/* --- times ------------------------------------------------------------------------------------ */

PyObject *pl_py_renderer_measure_scan(PyObject *self, PyObject *args) {
  PyObject *request, *source;
  int repeats;
  scan_call call = {.request = {.threads = 1}};
  if (!PyArg_ParseTuple(args, "OOi:measure_scan", &request, &source, &repeats) ||
      begin(&call, self, request, source, 1, 0) < 0)
    return NULL;
  pl_ray_times times;
  pl_status status;
  Py_BEGIN_ALLOW_THREADS status =
      pl_measure_scan(call.self->core, &call.request.placement, &call.scan.source, repeats, &times);
  Py_END_ALLOW_THREADS end(&call);
  return status == PL_OK ? Py_BuildValue("(ndd)", (Py_ssize_t)times.rays, times.ours_s, times.raw_s)
                         : pl_py_raise(status);
}
