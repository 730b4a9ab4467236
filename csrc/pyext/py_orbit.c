/* Bodies, orbits and the random number generator for Python. */
#include "pyext/py_orbit.h"

#include "math/philox.h"
#include "orbit/orientation.h"
#include "pyext/py_read.h"

PyDoc_STRVAR(orientation_doc,
             "body_orientation($module, name, tdb_day, tdb_fraction)\n--\n\n"
             "Body-fixed to ICRF quaternions (n, 4) at JD(TDB) = tdb_day + tdb_fraction (n,).");

static PyObject *body_orientation(PyObject *module, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"name", "tdb_day", "tdb_fraction", NULL};
  (void)module;
  const char *name = NULL;
  double day = 0.0;
  PyObject *fraction_object = NULL;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "sdO:body_orientation", names, &name, &day,
                                   &fraction_object))
    return NULL;
  const pl_celestial *body = NULL;
  const pl_status status = pl_celestial_require(name, &body);
  if (status != PL_OK)
    return pl_py_raise(status);
  PyArrayObject *fractions = pl_py_doubles(fraction_object, "tdb_fraction");
  if (!fractions)
    return NULL;
  npy_intp shape[2] = {PyArray_SIZE(fractions), 4};
  PyObject *out = PyArray_SimpleNew(2, shape, NPY_DOUBLE);
  if (out) {
    const double *fraction = PyArray_DATA(fractions);
    pl_quat *q = PyArray_DATA((PyArrayObject *)out);
    for (npy_intp i = 0; i < shape[0]; i++) {
      if (!isfinite(day) || !isfinite(fraction[i])) {
        Py_CLEAR(out);
        PyErr_Format(PyExc_ValueError, "tdb_day or tdb_fraction[%zd] is not finite", (Py_ssize_t)i);
        break;
      }
      q[i] = pl_celestial_orientation(body, day, fraction[i]);
    }
  }
  Py_DECREF(fractions);
  return out;
}

PyDoc_STRVAR(philox_doc, "philox($module, key, counter, count)\n--\n\n"
                         "`count` words of Philox4x64-10, as numpy.random.Philox gives them.");

static PyObject *philox(PyObject *module, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"key", "counter", "count", NULL};
  (void)module;
  PyObject *parts[6] = {NULL};
  Py_ssize_t count = 0;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "(OO)(OOOO)n:philox", names, &parts[0], &parts[1],
                                   &parts[2], &parts[3], &parts[4], &parts[5], &count))
    return NULL;
  uint64_t words[6];
  for (int i = 0; i < 6; i++) {
    words[i] = PyLong_AsUnsignedLongLong(parts[i]); /* OverflowError when negative or too large */
    if (PyErr_Occurred())
      return NULL;
  }
  if (count < 0) {
    PyErr_Format(PyExc_ValueError, "count is %zd, but must not be negative", count);
    return NULL;
  }
  npy_intp shape[1] = {count};
  PyObject *out = PyArray_SimpleNew(1, shape, NPY_UINT64);
  if (out)
    pl_philox_fill(words, words + 2, (size_t)count, PyArray_DATA((PyArrayObject *)out));
  return out;
}

#define KEYWORDS(function) ((PyCFunction)(void (*)(void))(function))
PyMethodDef pl_py_orbit_methods[] = {
    {"body_orientation", KEYWORDS(body_orientation), METH_VARARGS | METH_KEYWORDS, orientation_doc},
    {"philox", KEYWORDS(philox), METH_VARARGS | METH_KEYWORDS, philox_doc},
    {NULL, NULL, 0, NULL},
};

static PyObject *body_constants(const pl_celestial *body) {
  return Py_BuildValue("{s:d,s:(ddd),s:O,s:d,s:d,s:z}", "gm_m3_s2", body->gm_m3_s2, "radii_m",
                       body->radii_m[0], body->radii_m[1], body->radii_m[2], "orientation", Py_True,
                       "geometric_albedo", body->geometric_albedo, "bond_albedo", body->bond_albedo,
                       "parent", body->parent);
}

int pl_py_orbit_add_constants(PyObject *module) {
  PyObject *all = PyDict_New();
  if (!all)
    return -1;
  size_t count = 0;
  const pl_celestial *bodies = pl_celestial_table(&count);
  int status = 0;
  for (size_t i = 0; i < count && status == 0; i++) {
    PyObject *one = body_constants(&bodies[i]);
    status = one ? PyDict_SetItemString(all, bodies[i].name, one) : -1;
    Py_XDECREF(one);
  }
  if (status == 0)
    status = PyModule_AddObjectRef(module, "BODIES", all);
  Py_DECREF(all);
  return status;
}
