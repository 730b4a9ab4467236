#include "pyext/py_layers.h"

#include "pyext/py_read.h"
#include "pyext/py_types.h"

/* Reads (points, gauge_m, width_m, depth_m, spacing_m, imprint_m, chevron_rad, albedo). */
static int track_of(PyObject *item, PyArrayObject **array, pl_wheel_track *out) {
  const npy_intp shape[2] = {-1, 3};
  pl_wheel_shape *s = &out->shape;
  PyObject *points;
  if (!PyTuple_Check(item)) {
    PyErr_SetString(PyExc_TypeError, "must be a tuple of points and seven numbers");
    return -1;
  }
  if (!PyArg_ParseTuple(item, "Oddddddd:track", &points, &s->gauge_m, &s->width_m, &s->depth_m,
                        &s->spacing_m, &s->imprint_m, &s->chevron_rad, &s->albedo))
    return -1;
  *array = pl_py_array(points, "points", NPY_DOUBLE, 2, shape);
  if (*array == NULL)
    return -1;
  out->points = PyArray_DATA(*array);
  out->count = (size_t)PyArray_DIM(*array, 0);
  return 0;
}

int pl_py_tracks_of(PyObject *given, PyArrayObject *arrays[PL_PY_TRACKS], pl_wheel_track *out,
                    size_t *count) {
  const Py_ssize_t size = given != Py_None ? PySequence_Size(given) : 0;
  if (size < 0)
    return -1;
  if (size > PL_PY_TRACKS) {
    PyErr_Format(PyExc_ValueError, "tracks: %zd tracks; at most %d are supported", size,
                 (int)PL_PY_TRACKS);
    return -1;
  }
  for (Py_ssize_t n = 0; n < size; n++) {
    PyObject *item = PySequence_GetItem(given, n);
    const int failed = item == NULL || track_of(item, &arrays[n], &out[n]) < 0;
    Py_XDECREF(item);
    if (failed)
      return pl_py_prefix_error("tracks");
    *count = (size_t)n + 1;
  }
  return 0;
}

static int image_of(PyObject *given, PyObject *kept, const pl_raster **out) {
  if (given == Py_None)
    return 0;
  *out = pl_py_raster_of(given);
  return *out != NULL ? PyList_Append(kept, given) : -1;
}

/* Reads (heights, roughness, albedo, size_m, seed), each image a raster or None. */
static int texture_of(PyObject *item, PyObject *kept, pl_ground_texture *out) {
  PyObject *images[3];
  unsigned long long seed;
  *out = (pl_ground_texture){0};
  if (!PyTuple_Check(item)) {
    PyErr_SetString(PyExc_TypeError, "must be (heights, roughness, albedo, size_m, seed)");
    return -1;
  }
  if (!PyArg_ParseTuple(item, "OOOdK:texture", &images[0], &images[1], &images[2], &out->size_m,
                        &seed))
    return -1;
  out->seed = seed;
  return image_of(images[0], kept, &out->heights) < 0 ||
                 image_of(images[1], kept, &out->roughness) < 0 ||
                 image_of(images[2], kept, &out->albedo) < 0
             ? -1
             : 0;
}

int pl_py_textures_of(PyObject *given, PyObject *kept, pl_ground_texture out[PL_GROUND_TEXTURES],
                      size_t *count) {
  const Py_ssize_t size = given != Py_None ? PySequence_Size(given) : 0;
  if (size < 0)
    return -1;
  if (size > PL_GROUND_TEXTURES) {
    PyErr_Format(PyExc_ValueError, "textures: %zd textures; at most %d are supported", size,
                 (int)PL_GROUND_TEXTURES);
    return -1;
  }
  for (Py_ssize_t n = 0; n < size; n++) {
    PyObject *item = PySequence_GetItem(given, n);
    const int failed = item == NULL || texture_of(item, kept, &out[n]) < 0;
    Py_XDECREF(item);
    if (failed)
      return pl_py_prefix_error("textures");
  }
  *count = (size_t)size;
  return 0;
}
