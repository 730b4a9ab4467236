/* The type Propagator, and the readers of the kinds' specifications. */
#ifndef PL_PYEXT_PY_PROPAGATOR_H
#define PL_PYEXT_PY_PROPAGATOR_H

#include "orbit/celestial.h"
#include "orbit/propagator.h"
#include "pyext/py_common.h"

extern PyType_Spec pl_py_propagator_spec;

/* Makes a propagator from its mapping; times count from JD(TDB) = day + fraction. 0, or -1 with an
 * exception that starts with `where`. One for each kind: the table is in py_propagator.c. */
typedef int (*pl_py_propagator_reader)(PyObject *spec, const char *where, double day,
                                       double fraction, pl_propagator **out);

/* By the kind that spec names; `where` NULL stands for the kind's name. */
int pl_py_read_propagator(PyObject *spec, const char *where, double day, double fraction,
                          pl_propagator **out);

/* The reader of `numerical`, and the rows of the table of forces with their parameters. */
int pl_py_read_numerical(PyObject *spec, const char *where, double day, double fraction,
                         pl_propagator **out);
PyObject *pl_py_forces(void);

/* Borrowed content of a Propagator, and its epoch; NULL with TypeError for another type. */
const pl_propagator *pl_py_propagator_of(PyObject *object, double *day, double *fraction);

/* mapping[key] as a body of the table; None or a missing key gives NULL where `optional`. */
int pl_py_read_celestial(PyObject *mapping, const char *key, int optional, const char *where,
                         const pl_celestial **out);

#endif
