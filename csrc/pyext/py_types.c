/* Checks that all types of the module use. */
#include "pyext/py_types.h"

#include <string.h>

int pl_py_is(PyObject *object, void *dealloc) {
  return (PyType_GetFlags(Py_TYPE(object)) & Py_TPFLAGS_HEAPTYPE) != 0 &&
         PyType_GetSlot(Py_TYPE(object), Py_tp_dealloc) == dealloc;
}

/* Formats a shape as "(2, 7)", with "any" for free dimensions. */
static PyObject *shape_text(int nd, const npy_intp *shape) {
  PyObject *text = PyUnicode_FromString("(");
  for (int i = 0; i < nd && text != NULL; i++) {
    PyObject *longer = shape[i] < 0 ? PyUnicode_FromFormat("%U%sany", text, i > 0 ? ", " : "")
                                    : PyUnicode_FromFormat("%U%s%zd", text, i > 0 ? ", " : "",
                                                           (Py_ssize_t)shape[i]);
    Py_DECREF(text);
    text = longer;
  }
  return text;
}

static void raise_shape(const char *what, int nd, const npy_intp *shape, PyArrayObject *array) {
  PyObject *wanted = shape_text(nd, shape);
  PyObject *got = shape_text(PyArray_NDIM(array), PyArray_DIMS(array));
  if (wanted != NULL && got != NULL)
    PyErr_Format(PyExc_ValueError, "%s: shape must be %U), not %U)", what, wanted, got);
  Py_XDECREF(wanted);
  Py_XDECREF(got);
}

PyArrayObject *pl_py_own_array(PyObject *object, int type) {
  PyObject *given = PyArray_FROMANY(object, type, 0, 0, NPY_ARRAY_IN_ARRAY | NPY_ARRAY_ENSUREARRAY);
  if (given == NULL)
    return NULL;
  /* ENSURECOPY above would not suffice: NumPy counts the result of an object's __array__ as a copy
   * already. */
  PyObject *own =
      PyArray_FromArray((PyArrayObject *)given, PyArray_DescrFromType(type),
                        NPY_ARRAY_CARRAY | NPY_ARRAY_ENSURECOPY | NPY_ARRAY_ENSUREARRAY);
  Py_DECREF(given);
  return (PyArrayObject *)own;
}

int pl_py_keep_memory(PyObject *kept, PyObject *array) {
  /* NumPy does not resize an array that has weak references, even with refcheck=False. */
  for (PyObject *at = array; at != NULL && PyArray_Check(at);
       at = PyArray_BASE((PyArrayObject *)at)) {
    PyObject *weak = PyWeakref_NewRef(at, NULL);
    const int failed = weak == NULL || PyList_Append(kept, weak) < 0;
    Py_XDECREF(weak);
    if (failed)
      return -1;
  }
  return PyList_Append(kept, array);
}

PyArrayObject *pl_py_array(PyObject *object, const char *what, int type, int nd,
                           const npy_intp *shape) {
  PyArrayObject *array = pl_py_own_array(object, type);
  if (array == NULL)
    return NULL;
  int same = PyArray_NDIM(array) == nd;
  for (int i = 0; same && i < nd; i++)
    same = shape[i] < 0 || PyArray_DIM(array, i) == shape[i];
  if (!same) {
    raise_shape(what, nd, shape, array);
    Py_DECREF((PyObject *)array);
    return NULL;
  }
  return array;
}

PyObject *pl_py_records(PyObject *description, const void *records, size_t count, size_t size) {
  PyArray_Descr *descr = NULL;
  const npy_intp shape[1] = {(npy_intp)count};
  const int known =
      description != NULL && PyArray_DescrConverter(description, &descr) == NPY_SUCCEED;
  Py_XDECREF(description);
  if (!known)
    return NULL;
  PyObject *out = PyArray_NewFromDescr(&PyArray_Type, descr, 1, shape, NULL, NULL, 0, NULL);
  if (out != NULL && count > 0)
    memcpy(PyArray_DATA((PyArrayObject *)out), records, count * size);
  return out;
}
