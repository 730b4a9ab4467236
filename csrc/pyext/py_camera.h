/* Camera optics for Python. */
#ifndef PL_PYEXT_PY_CAMERA_H
#define PL_PYEXT_PY_CAMERA_H

#include "pyext/py_common.h"

#include "scene/scene.h"

/* Sets the intrinsics from K (3, 3) and the lens from (model, coefficients); None or NULL for no
 * lens. */
int pl_py_camera_optics(PyObject *k, PyObject *lens, pl_camera *out);
/* Sets aperture and focus from (aperture_m, distance_m); None or NULL for a pinhole. */
int pl_py_camera_focus(PyObject *focus, pl_camera *out);
/* Returns the table of lens models. */
PyObject *pl_py_lenses(void);
/* project(K, lens, points): pixel coordinates of points in camera axes; nan where a point has no
 * image. */
PyObject *pl_py_project(PyObject *module, PyObject *args);
/* unproject(K, lens, pixels): unit directions of pixels in camera axes; nan where the lens has
 * none. */
PyObject *pl_py_unproject(PyObject *module, PyObject *args);

#endif
