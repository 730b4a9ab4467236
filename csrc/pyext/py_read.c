/* Reads members of mappings as C values. */
#include "pyext/py_read.h"

#include <string.h>

#include "pyext/py_types.h"

int pl_py_prefix_error(const char *where) {
  PyObject *type = NULL, *value = NULL, *trace = NULL;
  PyErr_Fetch(&type, &value, &trace);
  if (!type || (!PyErr_GivenExceptionMatches(type, PyExc_ValueError) &&
                !PyErr_GivenExceptionMatches(type, PyExc_TypeError))) {
    PyErr_Restore(type, value, trace);
    return -1;
  }
  PyErr_NormalizeException(&type, &value, &trace);
  PyErr_Format(type, "%s: %S", where, value ? value : type);
  Py_XDECREF(type);
  Py_XDECREF(value);
  Py_XDECREF(trace);
  return -1;
}

int pl_py_member(PyObject *mapping, const char *key, int optional, const char *where,
                 PyObject **out) {
  *out = NULL;
  if (!PyMapping_Check(mapping)) {
    PyErr_Format(PyExc_TypeError, "%s: must be a mapping with the key '%s'", where, key);
    return -1;
  }
  *out = PyMapping_GetItemString(mapping, key);
  if (*out)
    return 0;
  if (!PyErr_ExceptionMatches(PyExc_KeyError))
    return pl_py_prefix_error(where);
  PyErr_Clear();
  if (!optional) {
    PyErr_Format(PyExc_ValueError, "%s: the key '%s' is missing", where, key);
    return -1;
  }
  Py_INCREF(Py_None);
  *out = Py_None;
  return 0;
}

int pl_py_member_double(PyObject *mapping, const char *key, const char *where, double *out) {
  PyObject *item = NULL;
  if (pl_py_member(mapping, key, 0, where, &item) < 0)
    return -1;
  *out = PyFloat_AsDouble(item);
  Py_DECREF(item);
  if (PyErr_Occurred()) {
    pl_py_prefix_error(key);
    return pl_py_prefix_error(where);
  }
  return 0;
}

int pl_py_member_doubles(PyObject *mapping, const char *key, const char *where, npy_intp count,
                         double *out) {
  PyObject *item = NULL;
  if (pl_py_member(mapping, key, 0, where, &item) < 0)
    return -1;
  PyArrayObject *array = pl_py_doubles(item, key);
  Py_DECREF(item);
  if (!array)
    return pl_py_prefix_error(where);
  if (PyArray_SIZE(array) != count) {
    PyErr_Format(PyExc_ValueError, "%s: %s has %zd numbers, but must have %zd", where, key,
                 (Py_ssize_t)PyArray_SIZE(array), (Py_ssize_t)count);
    Py_DECREF(array);
    return -1;
  }
  memcpy(out, PyArray_DATA(array), (size_t)count * sizeof *out);
  Py_DECREF(array);
  return 0;
}

int pl_py_member_text(PyObject *mapping, const char *key, const char *where, PyObject **owner,
                      const char **out) {
  *out = NULL;
  if (pl_py_member(mapping, key, 0, where, owner) < 0)
    return -1;
  if (PyUnicode_Check(*owner))
    *out = PyUnicode_AsUTF8AndSize(*owner, NULL);
  else
    PyErr_Format(PyExc_TypeError, "%s: %s must be text", where, key);
  if (*out)
    return 0;
  Py_CLEAR(*owner);
  return -1;
}

int pl_py_member_choice(PyObject *mapping, const char *key, const char *where,
                        const char *const *allowed, int count) {
  PyObject *owner = NULL;
  const char *text = NULL;
  if (pl_py_member_text(mapping, key, where, &owner, &text) < 0)
    return -1;
  int found = -1;
  for (int i = 0; i < count; i++)
    if (strcmp(text, allowed[i]) == 0)
      found = i;
  if (found < 0) {
    char names[200] = "";
    for (int i = 0; i < count; i++)
      pl_names_append(names, sizeof names, allowed[i]);
    PyErr_Format(PyExc_ValueError, "%s: %s is '%s'; allowed: %s", where, key, text, names);
  }
  Py_DECREF(owner);
  return found;
}

int pl_py_member_size(PyObject *mapping, const char *key, const char *where, size_t *out) {
  PyObject *item = NULL;
  if (pl_py_member(mapping, key, 0, where, &item) < 0)
    return -1;
  const Py_ssize_t value = PyNumber_AsSsize_t(item, PyExc_OverflowError);
  Py_DECREF(item);
  if (PyErr_Occurred()) {
    pl_py_prefix_error(key);
    return pl_py_prefix_error(where);
  }
  if (value < 0) {
    PyErr_Format(PyExc_ValueError, "%s: %s is %zd, but must not be negative", where, key, value);
    return -1;
  }
  *out = (size_t)value;
  return 0;
}

int pl_py_member_bool(PyObject *mapping, const char *key, const char *where, int *out) {
  PyObject *item = NULL;
  if (pl_py_member(mapping, key, 0, where, &item) < 0)
    return -1;
  *out = PyObject_IsTrue(item);
  Py_DECREF(item);
  return *out < 0 ? pl_py_prefix_error(where) : 0;
}

PyArrayObject *pl_py_member_array(PyObject *mapping, const char *key, const char *where, int nd,
                                  const npy_intp *shape) {
  PyObject *item = NULL;
  if (pl_py_member(mapping, key, 0, where, &item) < 0)
    return NULL;
  PyArrayObject *array = pl_py_array(item, key, NPY_DOUBLE, nd, shape);
  Py_DECREF(item);
  if (!array)
    pl_py_prefix_error(where);
  return array;
}

/* Returns 1 if the key is present and not None, else 0; -1 with an exception. */
static int has_member(PyObject *mapping, const char *key, const char *where) {
  PyObject *item = NULL;
  if (pl_py_member(mapping, key, 1, where, &item) < 0)
    return -1;
  const int there = item != Py_None;
  Py_DECREF(item);
  return there;
}

int pl_py_optional_double(PyObject *mapping, const char *key, const char *where, double *out) {
  const int there = has_member(mapping, key, where);
  return there > 0 ? pl_py_member_double(mapping, key, where, out) : there;
}

int pl_py_optional_seed(PyObject *mapping, const char *key, const char *where, uint64_t *out) {
  PyObject *item;
  if (pl_py_member(mapping, key, 1, where, &item) < 0)
    return -1;
  if (item != Py_None) {
    const uint64_t seed = PyLong_AsUnsignedLongLong(item);
    if (PyErr_Occurred()) {
      Py_DECREF(item);
      PyErr_Clear();
      PyErr_Format(PyExc_ValueError, "%s: %s must be an integer from 0 to 2^64 - 1", where, key);
      return -1;
    }
    *out = seed;
  }
  Py_DECREF(item);
  return 0;
}

int pl_py_optional_choice(PyObject *mapping, const char *key, const char *where,
                          const char *const *allowed, int count, int *out) {
  const int there = has_member(mapping, key, where);
  if (there <= 0)
    return there;
  const int choice = pl_py_member_choice(mapping, key, where, allowed, count);
  if (choice < 0)
    return -1;
  *out = choice;
  return 0;
}

int pl_py_optional_doubles(PyObject *mapping, const char *key, const char *where, npy_intp count,
                           double *out) {
  const int there = has_member(mapping, key, where);
  return there > 0 ? pl_py_member_doubles(mapping, key, where, count, out) : there;
}

int pl_py_check(pl_status status, const char *where) {
  if (status == PL_OK)
    return 0;
  pl_py_raise(status);
  return pl_py_prefix_error(where);
}

PyArrayObject *pl_py_doubles(PyObject *object, const char *name) {
  PyArrayObject *array = pl_py_own_array(object, NPY_DOUBLE);
  if (!array) {
    pl_py_prefix_error(name);
    return NULL;
  }
  if (PyArray_NDIM(array) != 1) {
    PyErr_Format(PyExc_ValueError, "%s has %d dimensions, but must have 1", name,
                 PyArray_NDIM(array));
    Py_DECREF(array);
    return NULL;
  }
  return array;
}
