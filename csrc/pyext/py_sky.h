/* The sky of a request, and the stars of a result. */
#ifndef PL_PYEXT_PY_SKY_H
#define PL_PYEXT_PY_SKY_H

#include "pyext/py_common.h"

#include "pyext/py_request.h"

/* Parses "sky" of the request dictionary, which may be absent or None. */
int pl_py_sky_parse(PyObject *request, pl_py_states *states, pl_frame_request *out);
/* Returns the visible stars as documented in the stub; a new reference. */
PyObject *pl_py_seen_stars(const pl_frame_result *result);

#endif
