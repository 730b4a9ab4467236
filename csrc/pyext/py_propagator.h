/* The type Propagator, and the parsers of each kind's specification. */
#ifndef PL_PYEXT_PY_PROPAGATOR_H
#define PL_PYEXT_PY_PROPAGATOR_H

#include "orbit/celestial.h"
#include "orbit/propagator.h"
#include "pyext/py_common.h"

extern PyType_Spec pl_py_propagator_spec;

/* Creates a propagator from its mapping; times are relative to JD(TDB) = day + fraction. Returns 0,
 * or -1 with an exception that starts with `where`. There is one for each kind: the table is in
 * py_propagator.c. */
typedef int (*pl_py_propagator_reader)(PyObject *spec, const char *where, double day,
                                       double fraction, pl_propagator **out);

/* Creates a propagator of the kind that spec names; a NULL `where` stands for the kind's name. */
int pl_py_read_propagator(PyObject *spec, const char *where, double day, double fraction,
                          pl_propagator **out);

/* The parser of the kind `numerical`, and the table of forces with their parameters. */
int pl_py_read_numerical(PyObject *spec, const char *where, double day, double fraction,
                         pl_propagator **out);
PyObject *pl_py_forces(void);

/* Returns the borrowed content of a Propagator and its epoch; NULL with TypeError for another
 * type. */
const pl_propagator *pl_py_propagator_of(PyObject *object, double *day, double *fraction);

/* Reads mapping[key] as a body of the table; None or a missing key gives NULL if `optional`. */
int pl_py_read_celestial(PyObject *mapping, const char *key, int optional, const char *where,
                         const pl_celestial **out);

#endif
