/* The functions clods and mottling: samples of ground that the core makes. */
#include "terrain/ground_sample.h"

#include "pyext/py_read.h"
#include "pyext/py_types.h"

/* Reads the number of pixels; an array of as many on a side, or NULL. */
static PyObject *open_sample(PyObject *given, const char *where, uint64_t *seed, int *pixels) {
  size_t side, number;
  if (pl_py_member_size(given, "seed", where, &number) < 0 ||
      pl_py_member_size(given, "pixels", where, &side) < 0)
    return NULL;
  *seed = number;
  *pixels = side <= PL_GROUND_SAMPLE_MOST ? (int)side : PL_GROUND_SAMPLE_MOST + 1;
  const npy_intp shape[2] = {*pixels, *pixels};
  return PyArray_SimpleNew(2, shape, NPY_FLOAT32);
}

static PyObject *finish(PyObject *array, pl_status status) {
  if (status == PL_OK)
    return array;
  Py_DECREF(array);
  return pl_py_raise(status);
}

PyObject *pl_py_clods(PyObject *module, PyObject *given) {
  static const char WHERE[] = "clods";
  pl_clods of;
  (void)module;
  PyObject *out = open_sample(given, WHERE, &of.seed, &of.pixels);
  if (out == NULL)
    return NULL;
  if (pl_py_member_double(given, "size_m", WHERE, &of.size_m) < 0 ||
      pl_py_member_double(given, "min_diameter_m", WHERE, &of.min_m) < 0 ||
      pl_py_member_double(given, "max_diameter_m", WHERE, &of.max_m) < 0 ||
      pl_py_member_double(given, "density_per_m2", WHERE, &of.density) < 0 ||
      pl_py_member_double(given, "exponent", WHERE, &of.exponent) < 0) {
    Py_DECREF(out);
    return NULL;
  }
  return finish(out, pl_clods_make(&of, PyArray_DATA((PyArrayObject *)out)));
}

PyObject *pl_py_mottling(PyObject *module, PyObject *given) {
  static const char WHERE[] = "mottling";
  pl_mottling of;
  (void)module;
  PyObject *out = open_sample(given, WHERE, &of.seed, &of.pixels);
  if (out == NULL)
    return NULL;
  if (pl_py_member_double(given, "cover", WHERE, &of.cover) < 0 ||
      pl_py_member_double(given, "border", WHERE, &of.border) < 0 ||
      pl_py_member_double(given, "hurst", WHERE, &of.hurst) < 0) {
    Py_DECREF(out);
    return NULL;
  }
  return finish(out, pl_mottling_make(&of, PyArray_DATA((PyArrayObject *)out)));
}
