/* Settings of label channels: of the ground, and of coverage. */
#include "pyext/py_ground.h"
#include "pyext/py_read.h"
#include "pyext/py_request.h"

static const char where[] = "ground_labels";

/* Reads (footprint_m, slope_rad, rms_m, rock_m). */
static int parse_hazard(PyObject *given, pl_hazard_limits *out) {
  double numbers[4];
  if (pl_py_member_doubles(given, "hazard", where, 4, numbers) < 0)
    return -1;
  *out = (pl_hazard_limits){numbers[0], numbers[1], numbers[2], numbers[3]};
  return 0;
}

int pl_py_ground_labels_parse(PyObject *request, pl_frame_request *out) {
  const npy_intp shape[1] = {-1};
  PyObject *given = PyDict_GetItemString(request, where);
  size_t points;
  if (given == NULL || given == Py_None)
    return PyErr_Occurred() ? -1 : 0;
  Py_INCREF(given);
  PyArrayObject *baselines = pl_py_member_array(given, "baselines_m", where, 1, shape);
  int failed = baselines == NULL || pl_py_member_size(given, "points", where, &points) < 0 ||
               parse_hazard(given, &out->ground.hazard) < 0;
  if (!failed && PyArray_DIM(baselines, 0) > PL_BASELINES_MAX) {
    PyErr_Format(PyExc_ValueError, "ground_labels: %zd baselines; at most %d are supported",
                 (Py_ssize_t)PyArray_DIM(baselines, 0), PL_BASELINES_MAX);
    failed = 1;
  }
  if (!failed) {
    out->ground.baseline_count = (int)PyArray_DIM(baselines, 0);
    out->ground.disc_points = points < INT_MAX ? (int)points : INT_MAX;
    for (int k = 0; k < out->ground.baseline_count; k++)
      out->ground.baselines_m[k] = ((const double *)PyArray_DATA(baselines))[k];
  }
  Py_XDECREF((PyObject *)baselines);
  Py_DECREF(given);
  return failed ? -1 : 0;
}

int pl_py_coverage_parse(PyObject *request, pl_frame_request *out) {
  static const char key[] = "coverage_labels";
  PyObject *given = PyDict_GetItemString(request, key);
  size_t samples, layers;
  if (given == NULL || given == Py_None)
    return PyErr_Occurred() ? -1 : 0;
  if (pl_py_member_size(given, "samples", key, &samples) < 0 ||
      pl_py_member_size(given, "layers", key, &layers) < 0)
    return -1;
  out->coverage.samples = samples < INT_MAX ? (int)samples : INT_MAX;
  out->coverage.layers = layers < INT_MAX ? (int)layers : INT_MAX;
  return 0;
}
