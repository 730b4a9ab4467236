/* The type Tree: nodes that move and rotate relative to each other. */
#ifndef PL_PYEXT_PY_TREE_H
#define PL_PYEXT_PY_TREE_H

#include "pyext/py_common.h"

extern PyType_Spec pl_py_tree_spec;

#endif
