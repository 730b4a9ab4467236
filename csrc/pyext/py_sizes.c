#include "pyext/py_sizes.h"

#include "base/memory.h"
#include "pyext/py_read.h"
#include "pyext/py_types.h"

static int copy_columns(PyArrayObject *array, pl_size_points *out, double **owner) {
  const size_t count = (size_t)PyArray_DIM(array, 0);
  double *columns = pl_alloc(2 * count, sizeof *columns);
  if (columns == NULL) {
    PyErr_NoMemory();
    return -1;
  }
  const double *from = PyArray_DATA(array);
  for (size_t k = 0; k < count; k++) {
    columns[k] = from[2 * k];
    columns[count + k] = from[2 * k + 1];
  }
  *owner = columns;
  *out = (pl_size_points){columns, columns + count, count};
  return 0;
}

int pl_py_size_points_of(PyObject *settings, const char *where, pl_size_points *out,
                         double **owner) {
  const npy_intp shape[2] = {-1, 2};
  PyObject *given;
  if (pl_py_member(settings, "table", 1, where, &given) < 0)
    return -1;
  int status = 0;
  if (given != Py_None) {
    PyArrayObject *array = pl_py_array(given, "table", NPY_DOUBLE, 2, shape);
    status = array != NULL ? copy_columns(array, out, owner) : pl_py_prefix_error(where);
    Py_XDECREF((PyObject *)array);
  }
  Py_DECREF(given);
  return status;
}
