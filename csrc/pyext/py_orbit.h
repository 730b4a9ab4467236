/* Python interface of orbit/ and of the random number generator. */
#ifndef PL_PYEXT_PY_ORBIT_H
#define PL_PYEXT_PY_ORBIT_H

#include "pyext/py_common.h"

/* body_orientation, philox; terminated by a NULL name. */
extern PyMethodDef pl_py_orbit_methods[];

/* Adds BODIES. Returns 0, or -1 with an exception set. */
int pl_py_orbit_add_constants(PyObject *module);

#endif
