/* Reading arguments: members of mappings, with errors that say where the value was. */
#ifndef PL_PYEXT_PY_READ_H
#define PL_PYEXT_PY_READ_H

#include "pyext/py_common.h"

/* All give 0, or -1 with an exception that starts with `where`, e.g. "node 'iss': motion". */

/* New reference to mapping[key]; a missing key is a ValueError, or Py_None if `optional`. */
int pl_py_member(PyObject *mapping, const char *key, int optional, const char *where,
                 PyObject **out);
int pl_py_member_double(PyObject *mapping, const char *key, const char *where, double *out);
/* `count` numbers from any sequence or array. */
int pl_py_member_doubles(PyObject *mapping, const char *key, const char *where, npy_intp count,
                         double *out);
/* UTF-8 text that lives as long as *owner, a new reference. */
int pl_py_member_text(PyObject *mapping, const char *key, const char *where, PyObject **owner,
                      const char **out);

/* Index of mapping[key] in the `count` texts of `allowed`, or -1. */
int pl_py_member_choice(PyObject *mapping, const char *key, const char *where,
                        const char *const *allowed, int count);
/* A whole number that is not negative. */
int pl_py_member_size(PyObject *mapping, const char *key, const char *where, size_t *out);
int pl_py_member_bool(PyObject *mapping, const char *key, const char *where, int *out);
/* A contiguous double array with these dimensions (-1: any); a new reference, or NULL. */
PyArrayObject *pl_py_member_array(PyObject *mapping, const char *key, const char *where, int nd,
                                  const npy_intp *shape);
/* As without `optional`, but a missing key or None leaves *out as it is. */
int pl_py_optional_double(PyObject *mapping, const char *key, const char *where, double *out);
int pl_py_optional_doubles(PyObject *mapping, const char *key, const char *where, npy_intp count,
                           double *out);

/* 0 for PL_OK, else sets the exception of `status`, prefixed with "where: ", and gives -1. */
int pl_py_check(pl_status status, const char *where);

/* Prefixes the current exception, if it is a ValueError or TypeError, with "where: "; returns -1.
 */
int pl_py_prefix_error(const char *where);

/* A contiguous double array of one dimension (new reference), or NULL. */
PyArrayObject *pl_py_doubles(PyObject *object, const char *name);

#endif
