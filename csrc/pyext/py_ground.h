/* Relief, water and lights of bodies, from Python. */
#ifndef PL_PYEXT_PY_GROUND_H
#define PL_PYEXT_PY_GROUND_H

#include "pyext/py_common.h"

#include "scene/scene.h"

/* The keyword `ground` of Scene.add_body, None or a dictionary as documented in the stub; maps are
 * appended to `kept`. -1 with an exception. */
int pl_py_ground_parse(PyObject *dict, PyObject *kept, pl_ground *out);
/* "body_ground" of a request, which may be absent. -1 with an exception. */
int pl_py_ground_states(PyObject *request, size_t count, pl_body_state *out);

#endif
