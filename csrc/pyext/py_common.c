/* Converts status codes to Python exceptions. */
#include "pyext/py_common.h"

#include <string.h>

static PyObject *exception_of(pl_status status) {
  switch (status) {
  case PL_E_IO:
    return PyExc_OSError;
  case PL_E_MEMORY:
    return PyExc_MemoryError;
  case PL_E_CANCELLED:
    return PyExc_KeyboardInterrupt;
  case PL_E_DEVICE:
    return PyExc_RuntimeError;
  case PL_E_ARGUMENT:
  case PL_E_RANGE:
  case PL_E_FORMAT:
  case PL_E_UNSUPPORTED:
    return PyExc_ValueError;
  case PL_OK:
  case PL_STATUS_COUNT:
    break;
  }
  return PyExc_SystemError; /* caller error: the status was not an error */
}

PyObject *pl_py_raise(pl_status status) {
  if (PyErr_Occurred())
    return NULL;
  /* Error texts may contain file names, which are not necessarily valid UTF-8. */
  const char *why = pl_error_text()[0] != '\0' ? pl_error_text() : pl_status_name(status);
  PyObject *text = PyUnicode_DecodeUTF8(why, (Py_ssize_t)strlen(why), "replace");
  if (text != NULL)
    PyErr_SetObject(exception_of(status), text);
  Py_XDECREF(text);
  return NULL;
}
