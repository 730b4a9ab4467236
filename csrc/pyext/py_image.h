/* Functions of the module for image files: see _core.pyi. */
#ifndef PL_PYEXT_PY_IMAGE_H
#define PL_PYEXT_PY_IMAGE_H

#include "pyext/py_common.h"

PyObject *pl_py_deflate(PyObject *module, PyObject *args);
PyObject *pl_py_exr_encode(PyObject *module, PyObject *args);
PyObject *pl_py_exr_decode(PyObject *module, PyObject *args);
PyObject *pl_py_png_encode(PyObject *module, PyObject *args, PyObject *kwargs);
PyObject *pl_py_png_grey(PyObject *module, PyObject *args);
PyObject *pl_py_png_write(PyObject *module, PyObject *args, PyObject *kwargs);

#endif
