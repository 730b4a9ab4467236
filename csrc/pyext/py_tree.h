/* The tree of nodes, read from Python's mappings. */
#ifndef PL_PYEXT_PY_TREE_H
#define PL_PYEXT_PY_TREE_H

#include "orbit/kepler.h"
#include "pyext/py_common.h"

/* An orbit from the mapping of elements; 0, or -1 with an exception that starts with `where`. */
int pl_py_read_orbit(PyObject *elements, double gm_m3_s2, const char *where, pl_orbit *out);

/* tree_poses(nodes, tdb_day, tdb_fraction, t_s). */
PyObject *pl_py_tree_poses(PyObject *module, PyObject *args, PyObject *kwargs);
extern const char pl_py_tree_poses_doc[];

#endif
