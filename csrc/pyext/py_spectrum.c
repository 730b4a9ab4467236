/* Spectral bands: the function band_gather, and the bands of a request. */
#include <string.h>

#include "light/spectrum.h"
#include "pyext/py_read.h"
#include "pyext/py_request.h"
#include "pyext/py_types.h"

enum { RESPONSES_MAX = 4 };

/* Borrows the points of an (n, 2) array; *kept gets the reference. */
static int curve_of(PyObject *object, const char *name, PyArrayObject **kept, pl_curve *out) {
  const npy_intp shape[2] = {-1, 2};
  *kept = pl_py_array(object, name, NPY_DOUBLE, 2, shape);
  if (*kept == NULL)
    return -1;
  out->points = (const double(*)[2])PyArray_DATA(*kept);
  out->count = (size_t)PyArray_DIM(*kept, 0);
  return 0;
}

static PyObject *triple_of(const double values[3]) {
  return Py_BuildValue("(ddd)", values[0], values[1], values[2]);
}

static PyObject *gather(PyObject *sun, PyObject *responses, double step_um,
                        PyArrayObject *kept[1 + RESPONSES_MAX]) {
  pl_curve light = {NULL, 0}, curves[RESPONSES_MAX];
  pl_band_light out;
  const Py_ssize_t count = PySequence_Size(responses);
  if (count < 0 || (sun != Py_None && curve_of(sun, "sun", &kept[0], &light) < 0))
    return NULL;
  if (count > RESPONSES_MAX)
    return pl_py_raise(pl_fail(PL_E_ARGUMENT, "at most %d responses", (int)RESPONSES_MAX));
  for (Py_ssize_t i = 0; i < count; i++) {
    PyObject *item = PySequence_GetItem(responses, i);
    const int failed = item == NULL || curve_of(item, "responses", &kept[1 + i], &curves[i]) < 0;
    Py_XDECREF(item);
    if (failed)
      return NULL;
  }
  const pl_status status =
      pl_band_gather(sun != Py_None ? &light : NULL, curves, (size_t)count, step_um, &out);
  if (status != PL_OK)
    return pl_py_raise(status);
  return Py_BuildValue("{s:N,s:N,s:d}", "part", triple_of(out.part), "moment_um",
                       triple_of(out.moment_um), "mean_um", out.mean_um);
}

PyObject *pl_py_band_gather(PyObject *module, PyObject *args) {
  PyObject *sun, *responses;
  PyArrayObject *kept[1 + RESPONSES_MAX] = {NULL};
  double step_um;
  (void)module;
  if (!PyArg_ParseTuple(args, "OOd:band_gather", &sun, &responses, &step_um))
    return NULL;
  PyObject *result = gather(sun, responses, step_um, kept);
  for (int i = 0; i <= RESPONSES_MAX; i++)
    Py_XDECREF((PyObject *)kept[i]);
  return result;
}

int pl_py_bands_parse(PyObject *request, pl_py_states *states, pl_frame_request *out) {
  const npy_intp shape[2] = {-1, 3};
  PyObject *value = Py_XNewRef(PyDict_GetItemString(request, "bands"));
  out->band_count = 0;
  if (value == NULL)
    return PyErr_Occurred() ? -1 : 0;
  PyArrayObject *array = pl_py_array(value, "bands", NPY_DOUBLE, 2, shape);
  Py_DECREF(value);
  if (array == NULL)
    return -1;
  const npy_intp count = PyArray_DIM(array, 0);
  if (count < 1 || count > PL_BANDS_MAX)
    PyErr_Format(PyExc_ValueError, "bands: between 1 and %d, not %zd", (int)PL_BANDS_MAX,
                 (Py_ssize_t)count);
  else
    for (npy_intp i = 0; i < 3 * count; i++)
      states->bands[i / 3][i % 3] = (float)((const double *)PyArray_DATA(array))[i];
  Py_DECREF((PyObject *)array);
  if (PyErr_Occurred())
    return -1;
  out->band_parts = (const float(*)[3])states->bands;
  out->band_count = (int)count;
  return 0;
}

/* "planes" (planes, 2, 3), weights and wavelengths in m: may be absent or None. */
static int parse_planes(PyObject *dict, pl_py_states *states, pl_sensor *out) {
  PyObject *value;
  const npy_intp shape[3] = {-1, 2, 3};
  if (pl_py_member(dict, "planes", 1, "sensor", &value) < 0)
    return -1;
  const bool given = value != Py_None;
  PyArrayObject *array = given ? pl_py_array(value, "sensor: planes", NPY_DOUBLE, 3, shape) : NULL;
  Py_DECREF(value);
  if (array == NULL)
    return given ? -1 : 0;
  const npy_intp count = PyArray_DIM(array, 0);
  if (count >= 1 && count <= PL_BANDS_MAX)
    memcpy(states->planes, PyArray_DATA(array), (size_t)count * sizeof *states->planes);
  else
    PyErr_Format(PyExc_ValueError, "sensor: between 1 and %d planes, not %zd", (int)PL_BANDS_MAX,
                 (Py_ssize_t)count);
  Py_DECREF((PyObject *)array);
  out->planes = states->planes;
  out->plane_count = (size_t)count;
  return PyErr_Occurred() ? -1 : 0;
}

int pl_py_filters_parse(PyObject *sensor, pl_py_states *states, pl_sensor *out) {
  PyObject *value;
  const npy_intp shape[2] = {3, 3};
  if (pl_py_member(sensor, "mix", 1, "sensor", &value) < 0)
    return -1;
  out->mixed = value != Py_None;
  PyArrayObject *array =
      out->mixed ? pl_py_array(value, "sensor: mix", NPY_DOUBLE, 2, shape) : NULL;
  Py_DECREF(value);
  if (array != NULL)
    memcpy(out->mix, PyArray_DATA(array), sizeof out->mix);
  Py_XDECREF((PyObject *)array);
  return out->mixed && array == NULL ? -1 : parse_planes(sensor, states, out);
}
