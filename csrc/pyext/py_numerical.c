/* Reads the numerical propagator and its forces from mappings. */
#include <string.h>

#include "base/memory.h"
#include "orbit/numerical.h"
#include "pyext/py_propagator.h"
#include "pyext/py_read.h"
#include "pyext/py_types.h"

#define WHERE_SIZE 160
#define KEYS_SIZE 400
#define DEFAULT_RTOL 1e-12

/* A specification during parsing; freed by clear_parts. */
typedef struct parts {
  pl_numerical_spec spec; /* owns forces and motions until the propagator takes ownership */
  PyObject *names;        /* list of the names of the motions, in their order */
} parts;

static void clear_parts(parts *p) {
  for (size_t i = 0; i < p->spec.force_count; i++)
    pl_free(p->spec.forces[i]);
  for (size_t i = 0; i < p->spec.motion_count; i++)
    pl_propagator_destroy(p->spec.motions[i]);
  pl_free(p->spec.forces);
  pl_free(p->spec.motions);
  Py_XDECREF(p->names);
}

/* Reads spec['motions']: name -> specification of a propagator with the same centre. */
static int read_motions(PyObject *spec, const char *where, parts *p) {
  PyObject *mapping = NULL;
  if (pl_py_member(spec, "motions", 1, where, &mapping) < 0)
    return -1;
  if (mapping != Py_None && !PyDict_Check(mapping)) {
    Py_DECREF(mapping);
    PyErr_Format(PyExc_TypeError, "%s: motions must be a dict", where);
    return -1;
  }
  p->names = mapping == Py_None ? PyList_New(0) : PyDict_Keys(mapping);
  const Py_ssize_t count = p->names ? PyList_Size(p->names) : 0;
  int result = p->names
                   ? pl_py_check(pl_alloc_or_fail((size_t)count, sizeof *p->spec.motions,
                                                  "motions of forces", (void **)&p->spec.motions),
                                 where)
                   : -1;
  for (Py_ssize_t i = 0; i < count && result == 0; i++) {
    PyObject *name = PyList_GetItem(p->names, i); /* borrowed */
    PyObject *item = PyObject_GetItem(mapping, name);
    const char *text = PyUnicode_Check(name) ? PyUnicode_AsUTF8AndSize(name, NULL) : "motions";
    char inner[WHERE_SIZE];
    snprintf(inner, sizeof inner, "%.80s: motions: %.60s", where, text ? text : "");
    result = item && text ? pl_py_read_propagator(item, inner, p->spec.setting.tdb_day,
                                                  p->spec.setting.tdb_fraction, &p->spec.motions[i])
                          : -1;
    Py_XDECREF(item);
    if (result == 0)
      p->spec.motion_count++;
  }
  Py_DECREF(mapping);
  return result;
}

/* Reads numbers of any shape, in C order; *array owns them. */
static int read_numbers(PyObject *item, const char *key, pl_force_value *out,
                        PyArrayObject **array) {
  *array = pl_py_own_array(item, NPY_DOUBLE);
  if (!*array)
    return pl_py_prefix_error(key);
  out->numbers = PyArray_DATA(*array);
  out->count = (size_t)PyArray_SIZE(*array);
  if (out->count > 0)
    return 0;
  PyErr_Format(PyExc_ValueError, "%s is empty", key);
  return -1;
}

static int read_reference(PyObject *item, const char *key, const parts *p, pl_force_value *out) {
  const Py_ssize_t count = PyList_Size(p->names);
  for (Py_ssize_t i = 0; i < count; i++) {
    const int same = PyObject_RichCompareBool(item, PyList_GetItem(p->names, i), Py_EQ);
    if (same < 0)
      return -1;
    if (same) {
      out->motion = p->spec.motions[i];
      return 0;
    }
  }
  PyErr_Format(PyExc_ValueError, "%s is %R; 'motions' has: %R", key, item, p->names);
  return -1;
}

static int read_value(PyObject *mapping, const pl_force_parameter *parameter, const parts *p,
                      pl_force_value *out, PyArrayObject **array) {
  if (parameter->type == PL_FORCE_BODY) /* whether it is required is checked with the row */
    return pl_py_read_celestial(mapping, parameter->key, 1, "parameters", &out->body);
  PyObject *item = NULL;
  if (pl_py_member(mapping, parameter->key, 1, "parameters", &item) < 0)
    return -1;
  int result = 0;
  if (item != Py_None)
    result = parameter->type == PL_FORCE_NUMBERS ? read_numbers(item, parameter->key, out, array)
                                                 : read_reference(item, parameter->key, p, out);
  Py_DECREF(item);
  return result;
}

/* Rejects unknown keys, so that a misspelt parameter is not ignored. */
static int check_keys(PyObject *mapping, const pl_force_kind *kind) {
  char keys[KEYS_SIZE] = "kind";
  for (size_t i = 0; i < kind->parameter_count; i++)
    pl_names_append(keys, sizeof keys, kind->parameters[i].key);
  PyObject *given = PyMapping_Keys(mapping);
  if (!given)
    return -1;
  const Py_ssize_t count = PyList_Size(given);
  int result = 0;
  for (Py_ssize_t k = 0; k < count && result == 0; k++) {
    PyObject *key = PyList_GetItem(given, k);
    const char *text = PyUnicode_Check(key) ? PyUnicode_AsUTF8AndSize(key, NULL) : NULL;
    int known = text && strcmp(text, "kind") == 0;
    for (size_t i = 0; text && i < kind->parameter_count; i++)
      known |= strcmp(text, kind->parameters[i].key) == 0;
    if (!known) {
      PyErr_Clear();
      PyErr_Format(PyExc_ValueError, "unknown key %R; allowed: %s", key, keys);
      result = -1;
    }
  }
  Py_DECREF(given);
  return result;
}

static int read_parameters(PyObject *mapping, const pl_force_kind *kind, const parts *p,
                           pl_force **out) {
  pl_force_value values[PL_FORCE_PARAMETERS] = {{0}};
  PyArrayObject *arrays[PL_FORCE_PARAMETERS] = {NULL};
  int result = check_keys(mapping, kind);
  for (size_t i = 0; i < kind->parameter_count && result == 0; i++)
    result = read_value(mapping, &kind->parameters[i], p, &values[i], &arrays[i]);
  if (result == 0) {
    const pl_status status = pl_force_create(kind, &p->spec.setting, values, out);
    if (status != PL_OK) {
      pl_py_raise(status);
      result = -1;
    }
  }
  for (size_t i = 0; i < PL_FORCE_PARAMETERS; i++)
    Py_XDECREF((PyObject *)arrays[i]);
  return result;
}

static int read_force(PyObject *mapping, const char *where, const parts *p, pl_force **out) {
  PyObject *owner = NULL;
  const char *name = NULL;
  if (pl_py_member_text(mapping, "kind", where, &owner, &name) < 0)
    return -1;
  const pl_force_kind *kind = NULL;
  int result = pl_py_check(pl_force_require(name, &kind), where);
  if (result == 0 && read_parameters(mapping, kind, p, out) < 0) {
    char inner[WHERE_SIZE];
    snprintf(inner, sizeof inner, "%.120s (%s)", where, kind->name);
    result = pl_py_prefix_error(inner);
  }
  Py_DECREF(owner);
  return result;
}

static int read_forces(PyObject *spec, const char *where, parts *p) {
  PyObject *list = NULL;
  if (pl_py_member(spec, "forces", 1, where, &list) < 0)
    return -1;
  if (list != Py_None && !PySequence_Check(list)) {
    Py_DECREF(list);
    PyErr_Format(PyExc_TypeError, "%s: forces must be a sequence", where);
    return -1;
  }
  const Py_ssize_t count = list == Py_None ? 0 : PySequence_Size(list);
  int result = count < 0 ? pl_py_prefix_error(where)
                         : pl_py_check(pl_alloc_or_fail((size_t)count, sizeof *p->spec.forces,
                                                        "forces", (void **)&p->spec.forces),
                                       where);
  for (Py_ssize_t i = 0; i < count && result == 0; i++) {
    char inner[WHERE_SIZE];
    snprintf(inner, sizeof inner, "%.100s: forces[%zd]", where, i);
    PyObject *item = PySequence_GetItem(list, i);
    result = item ? read_force(item, inner, p, &p->spec.forces[i]) : -1;
    Py_XDECREF(item);
    if (result == 0)
      p->spec.force_count++;
  }
  Py_DECREF(list);
  return result;
}

int pl_py_read_numerical(PyObject *spec, const char *where, double day, double fraction,
                         pl_propagator **out) {
  parts p = {.spec = {.setting = {.tdb_day = day, .tdb_fraction = fraction}, .rtol = DEFAULT_RTOL}};
  int result = -1;
  if (pl_py_member_double(spec, "gm", where, &p.spec.setting.gm_m3_s2) == 0 &&
      pl_py_member_doubles(spec, "state", where, 6, &p.spec.state.r_m.x) == 0 &&
      pl_py_optional_double(spec, "rtol", where, &p.spec.rtol) == 0 &&
      pl_py_optional_double(spec, "surface_m", where, &p.spec.surface_m) == 0 &&
      read_motions(spec, where, &p) == 0 && read_forces(spec, where, &p) == 0)
    result = pl_py_check(pl_numerical_create(&p.spec, out), where);
  if (result == 0) /* the propagator owns everything except the lists themselves */
    p.spec.force_count = p.spec.motion_count = 0;
  clear_parts(&p);
  return result;
}

static PyObject *parameter_row(const pl_force_parameter *p) {
  static const char *const types[] = {"numbers", "body", "motion"};
  return Py_BuildValue("{s:s,s:s,s:n,s:O,s:s}", "key", p->key, "type", types[p->type], "count",
                       (Py_ssize_t)p->count, "optional", p->optional ? Py_True : Py_False, "doc",
                       p->doc);
}

static PyObject *force_row(const pl_force_kind *kind) {
  PyObject *parameters = PyTuple_New((Py_ssize_t)kind->parameter_count);
  for (size_t i = 0; parameters && i < kind->parameter_count; i++) {
    PyObject *row = parameter_row(&kind->parameters[i]);
    if (!row || PyTuple_SetItem(parameters, (Py_ssize_t)i, row) < 0)
      Py_CLEAR(parameters);
  }
  return parameters ? Py_BuildValue("{s:s,s:s,s:N}", "name", kind->name, "doc", kind->doc,
                                    "parameters", parameters)
                    : NULL;
}

PyObject *pl_py_forces(void) {
  size_t count = 0;
  const pl_force_kind *const *kinds = pl_force_kinds(&count);
  PyObject *rows = PyTuple_New((Py_ssize_t)count);
  for (size_t i = 0; rows && i < count; i++) {
    PyObject *row = force_row(kinds[i]);
    if (!row || PyTuple_SetItem(rows, (Py_ssize_t)i, row) < 0)
      Py_CLEAR(rows);
  }
  return rows;
}
