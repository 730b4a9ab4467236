/* Relief, water and night lights of bodies. */
#include "pyext/py_ground.h"

#include <string.h>

#include "pyext/py_read.h"
#include "pyext/py_types.h"

/* Gets a map of the dictionary and appends it to `kept`; NULL when absent or None. */
static int get_map(PyObject *dict, const char *key, PyObject *kept, const pl_texture **out) {
  PyObject *value;
  *out = NULL;
  if (pl_py_member(dict, key, 1, "ground", &value) < 0)
    return -1;
  if (value != Py_None)
    *out = pl_py_map_of(value);
  const int failed = (value != Py_None && *out == NULL) || PyList_Append(kept, value) < 0;
  Py_DECREF(value);
  return failed ? -1 : 0;
}

int pl_py_ground_parse(PyObject *dict, PyObject *kept, pl_ground *out) {
  if (dict == Py_None)
    return 0;
  if (!PyDict_Check(dict)) {
    PyErr_SetString(PyExc_TypeError, "ground must be a dict or None");
    return -1;
  }
  if (get_map(dict, "heights", kept, &out->heights) < 0 ||
      get_map(dict, "normals", kept, &out->normals) < 0 ||
      get_map(dict, "water", kept, &out->water) < 0 ||
      get_map(dict, "lights", kept, &out->lights) < 0)
    return -1;
  PyObject *south = PyDict_GetItemString(dict, "south");
  PyObject *ocean = PyDict_GetItemString(dict, "ocean");
  out->north = south == Py_True ? -1.0f : 1.0f;
  out->ocean = ocean == Py_True;
  return PyErr_Occurred() ? -1 : 0;
}

int pl_py_ground_states(PyObject *request, size_t count, pl_body_state *out) {
  enum { ROW = 10 };
  const npy_intp shape[2] = {(npy_intp)count, ROW};
  PyObject *given = Py_XNewRef(PyDict_GetItemString(request, "body_ground"));
  for (size_t i = 0; i < count; i++)
    memset(&out[i].ground, 0, sizeof out[i].ground);
  if (given == NULL)
    return PyErr_Occurred() ? -1 : 0;
  PyArrayObject *array = pl_py_array(given, "body_ground", NPY_DOUBLE, 2, shape);
  Py_DECREF(given);
  if (array == NULL)
    return -1;
  for (size_t i = 0; i < count; i++) {
    const double *row = (const double *)PyArray_DATA(array) + ROW * i;
    pl_ground_state *ground = &out[i].ground;
    ground->height_m = (float)row[0];
    ground->steepness = (float)row[1];
    ground->wind_m_s = (float)row[2];
    for (size_t k = 0; k < 3; k++) {
      ground->water[k] = (float)row[3 + k];
      ground->lights[k] = (float)row[6 + k];
    }
    ground->towns_m = (float)row[9];
  }
  Py_DECREF((PyObject *)array);
  return 0;
}
