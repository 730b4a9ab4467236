/* Relief, water and night lights of bodies, for Python. */
#ifndef PL_PYEXT_PY_GROUND_H
#define PL_PYEXT_PY_GROUND_H

#include "pyext/py_common.h"

#include "scene/scene.h"

/* Parses the keyword `ground` of Scene.add_body: None or a dictionary as documented in the stub;
 * maps are appended to `kept`. Returns -1 with an exception. */
int pl_py_ground_parse(PyObject *dict, PyObject *kept, pl_ground *out);
/* Parses "body_ground" of a request, which may be absent. Returns -1 with an exception. */
int pl_py_ground_states(PyObject *request, size_t count, pl_body_state *out);

#endif
