/* Reads members of mappings, with errors that name the location of the value. */
#ifndef PL_PYEXT_PY_READ_H
#define PL_PYEXT_PY_READ_H

#include "pyext/py_common.h"

/* All return 0, or -1 with an exception that starts with `where`, e.g. "node 'iss': motion". */

/* Gets a new reference to mapping[key]; a missing key is a ValueError, or Py_None if `optional`. */
int pl_py_member(PyObject *mapping, const char *key, int optional, const char *where,
                 PyObject **out);
int pl_py_member_double(PyObject *mapping, const char *key, const char *where, double *out);
/* Reads `count` numbers from any sequence or array. */
int pl_py_member_doubles(PyObject *mapping, const char *key, const char *where, npy_intp count,
                         double *out);
/* Reads UTF-8 text; it is valid as long as *owner, a new reference. */
int pl_py_member_text(PyObject *mapping, const char *key, const char *where, PyObject **owner,
                      const char **out);

/* Returns the index of mapping[key] in the `count` strings of `allowed`, or -1. */
int pl_py_member_choice(PyObject *mapping, const char *key, const char *where,
                        const char *const *allowed, int count);
/* Reads a non-negative integer. */
int pl_py_member_size(PyObject *mapping, const char *key, const char *where, size_t *out);
int pl_py_member_bool(PyObject *mapping, const char *key, const char *where, int *out);
/* Reads a contiguous double array with these dimensions (-1: any); returns a new reference, or
 * NULL. */
PyArrayObject *pl_py_member_array(PyObject *mapping, const char *key, const char *where, int nd,
                                  const npy_intp *shape);
/* As the functions above, but a missing key or None leaves *out unchanged. */
int pl_py_optional_double(PyObject *mapping, const char *key, const char *where, double *out);
int pl_py_optional_seed(PyObject *mapping, const char *key, const char *where, uint64_t *out);
/* An index as of pl_py_member_choice. */
int pl_py_optional_choice(PyObject *mapping, const char *key, const char *where,
                          const char *const *allowed, int count, int *out);
int pl_py_optional_doubles(PyObject *mapping, const char *key, const char *where, npy_intp count,
                           double *out);

/* Returns 0 for PL_OK; else sets the exception of `status`, prefixed with "where: ", and returns
 * -1. */
int pl_py_check(pl_status status, const char *where);

/* Prefixes the current exception, if it is a ValueError or TypeError, with "where: "; returns
 * -1. */
int pl_py_prefix_error(const char *where);

/* Returns a contiguous one-dimensional double array (new reference), or NULL. */
PyArrayObject *pl_py_doubles(PyObject *object, const char *name);

#endif
