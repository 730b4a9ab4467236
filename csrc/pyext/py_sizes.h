/* What the types of craters and of rocks read alike. */
#ifndef PL_PYEXT_PY_SIZES_H
#define PL_PYEXT_PY_SIZES_H

#include "pyext/py_common.h"
#include "terrain/size_points.h"

/* Reads the optional member `table`, (n, 2) doubles: its columns are copied to a block of memory,
 * `*owner`, which pl_free frees. Returns 0, or -1 with an exception that starts with `where`. */
int pl_py_size_points_of(PyObject *settings, const char *where, pl_size_points *out,
                         double **owner);

#endif
