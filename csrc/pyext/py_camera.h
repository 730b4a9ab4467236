/* The optics of a camera for Python. */
#ifndef PL_PYEXT_PY_CAMERA_H
#define PL_PYEXT_PY_CAMERA_H

#include "pyext/py_common.h"

#include "scene/scene.h"

/* Sets the intrinsics by K (3, 3) and the lens by (model, coefficients), None or NULL. */
int pl_py_camera_optics(PyObject *k, PyObject *lens, pl_camera *out);
/* Sets aperture and focus by (aperture_m, distance_m); None or NULL: a pinhole. */
int pl_py_camera_focus(PyObject *focus, pl_camera *out);
/* The table of lenses. */
PyObject *pl_py_lenses(void);
/* project(K, lens, points): pixels of points in camera axes; nan where there is no image. */
PyObject *pl_py_project(PyObject *module, PyObject *args);

#endif
