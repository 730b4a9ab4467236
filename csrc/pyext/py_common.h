/* Common header of the extension: Python, NumPy, and conversion of a status to an exception.
 *
 * The limited API keeps one binary for all versions from 3.11. NumPy's function table is imported
 * once, by module.c, which defines PL_IMPORT_NUMPY before it includes this. */
#ifndef PL_PYEXT_PY_COMMON_H
#define PL_PYEXT_PY_COMMON_H

#ifndef Py_LIMITED_API
#define Py_LIMITED_API 0x030B0000
#endif
#ifndef PY_SSIZE_T_CLEAN
#define PY_SSIZE_T_CLEAN
#endif
#include <stdio.h> /* NumPy needs FILE; the limited API does not bring it */

#include <Python.h>

#ifndef NPY_NO_DEPRECATED_API
#define NPY_NO_DEPRECATED_API NPY_2_0_API_VERSION
#endif
#ifndef NPY_TARGET_VERSION
#define NPY_TARGET_VERSION NPY_2_0_API_VERSION
#endif
#define PY_ARRAY_UNIQUE_SYMBOL pl_numpy_api
#ifndef PL_IMPORT_NUMPY
#define NO_IMPORT_ARRAY
#endif
#include <numpy/arrayobject.h>

#include "base/status.h"

/* Sets the exception for `status` with pl_error_text() as its text; returns NULL. An exception that
 * is already set (e.g. by a signal handler) is kept. */
PyObject *pl_py_raise(pl_status status);

#endif
