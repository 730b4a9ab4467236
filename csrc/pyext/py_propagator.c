/* Reads propagators from mappings and returns their states as arrays. */
#include "pyext/py_propagator.h"

#include <string.h>

#include "orbit/anomaly.h"
#include "orbit/circular.h"
#include "orbit/elements.h"
#include "orbit/j2.h"
#include "orbit/numerical.h"
#include "orbit/orientation.h"
#include "orbit/table.h"
#include "orbit/two_body.h"
#include "pyext/py_read.h"
#include "pyext/py_types.h"

#define NAMES_SIZE 200

int pl_py_read_celestial(PyObject *mapping, const char *key, int optional, const char *where,
                         const pl_celestial **out) {
  *out = NULL;
  PyObject *item = NULL;
  if (pl_py_member(mapping, key, optional, where, &item) < 0)
    return -1;
  int result = 0;
  if (item != Py_None || !optional) {
    const char *name = PyUnicode_Check(item) ? PyUnicode_AsUTF8AndSize(item, NULL) : NULL;
    if (!name) {
      PyErr_Clear();
      PyErr_Format(PyExc_TypeError, "%s: %s must be the name of a body", where, key);
      result = -1;
    } else {
      result = pl_py_check(pl_celestial_require(name, out), where);
    }
  }
  Py_DECREF(item);
  return result;
}

/* Returns which of the keys for the position on the orbit at the epoch is present; -1 with an
 * exception unless there is exactly one. */
static int read_anomaly(PyObject *elements, const char *where, double *value) {
  static const char *const keys[] = {"since_periapsis_s", "mean_anomaly_rad", "true_anomaly_rad"};
  int found = -1, count = 0;
  for (int i = 0; i < 3; i++) {
    double number = NAN;
    if (pl_py_optional_double(elements, keys[i], where, &number) < 0)
      return -1;
    PyObject *item = NULL;
    if (pl_py_member(elements, keys[i], 1, where, &item) < 0)
      return -1;
    if (item != Py_None) {
      *value = number;
      found = i;
      count++;
    }
    Py_DECREF(item);
  }
  if (count == 1)
    return found;
  PyErr_Format(PyExc_ValueError, "%s: elements need one of %s, %s and %s", where, keys[0], keys[1],
               keys[2]);
  return -1;
}

static int read_elements(PyObject *elements, double gm, const char *where, pl_elements *out) {
  const struct {
    const char *key;
    double *value;
  } members[] = {
      {"periapsis_m", &out->periapsis_m},
      {"eccentricity", &out->eccentricity},
      {"inclination_rad", &out->inclination_rad},
      {"raan_rad", &out->raan_rad},
      {"arg_periapsis_rad", &out->arg_periapsis_rad},
  };
  for (size_t i = 0; i < sizeof members / sizeof members[0]; i++)
    if (pl_py_member_double(elements, members[i].key, where, members[i].value) < 0)
      return -1;
  double value = 0.0;
  const int kind = read_anomaly(elements, where, &value);
  if (kind < 0)
    return -1;
  out->since_periapsis_s = value;
  if (kind == 0)
    return 0;
  return pl_py_check(kind == 1 ? pl_elements_set_mean_anomaly(out, gm, value)
                               : pl_elements_set_true_anomaly(out, gm, value),
                     where);
}

/* Reads spec['elements'] or spec['state'] as an orbit at the epoch, in the axes of
 * spec['frame']. */
static int read_orbit(PyObject *spec, const char *where, pl_orbit *out) {
  double gm = 0.0;
  PyObject *elements = NULL;
  if (pl_py_member_double(spec, "gm", where, &gm) < 0 ||
      pl_py_member(spec, "elements", 1, where, &elements) < 0)
    return -1;
  int result;
  if (elements != Py_None) {
    pl_elements el;
    result = read_elements(elements, gm, where, &el);
    if (result == 0)
      result = pl_py_check(pl_orbit_from_elements(&el, gm, out), where);
  } else {
    pl_state state;
    result = pl_py_member_doubles(spec, "state", where, 6, &state.r_m.x);
    if (result == 0)
      result = pl_py_check(pl_orbit_from_state(&state, gm, out), where);
  }
  Py_DECREF(elements);
  return result;
}

/* Rotation from the axes of spec['frame'] at the epoch to ICRF. */
static int read_frame(PyObject *spec, const char *where, double day, double fraction,
                      pl_quat *out) {
  static const char *const frames[] = {"icrf", "equator"};
  const pl_celestial *body = NULL;
  const int frame = pl_py_member_choice(spec, "frame", where, frames, 2);
  if (frame < 0 || pl_py_read_celestial(spec, "parent_body", 1, where, &body) < 0)
    return -1;
  if (frame == 1 && !body) {
    PyErr_Format(PyExc_ValueError, "%s: the frame 'equator' needs parent_body", where);
    return -1;
  }
  *out = frame == 1 ? pl_celestial_equator(body, day, fraction) : PL_QUAT_IDENTITY;
  return 0;
}

static int read_kepler(PyObject *spec, const char *where, double day, double fraction,
                       pl_propagator **out) {
  pl_orbit orbit;
  pl_quat frame;
  if (read_frame(spec, where, day, fraction, &frame) < 0 || read_orbit(spec, where, &orbit) < 0)
    return -1;
  return pl_py_check(pl_kepler_create(&orbit, frame, out), where);
}

static int read_circular(PyObject *spec, const char *where, double day, double fraction,
                         pl_propagator **out) {
  (void)day, (void)fraction;
  pl_circle circle;
  if (pl_py_member_doubles(spec, "radii_m", where, 3, &circle.radii_m.x) < 0 ||
      pl_py_member_doubles(spec, "q", where, 4, &circle.q.w) < 0 ||
      pl_py_member_double(spec, "start_rev", where, &circle.start_rev) < 0 ||
      pl_py_member_double(spec, "rate_rev_s", where, &circle.rate_rev_s) < 0)
    return -1;
  return pl_py_check(pl_circular_create(&circle, out), where);
}

static int read_j2(PyObject *spec, const char *where, double day, double fraction,
                   pl_propagator **out) {
  pl_orbit orbit;
  pl_quat frame, equator = PL_QUAT_IDENTITY;
  pl_flattening flattening;
  const pl_celestial *body = NULL;
  int osculating = 0;
  if (read_frame(spec, where, day, fraction, &frame) < 0 ||
      pl_py_read_celestial(spec, "parent_body", 1, where, &body) < 0 ||
      read_orbit(spec, where, &orbit) < 0 ||
      pl_py_member_double(spec, "j2", where, &flattening.j2) < 0 ||
      pl_py_member_double(spec, "radius_m", where, &flattening.radius_m) < 0 ||
      pl_py_member_bool(spec, "osculating", where, &osculating) < 0)
    return -1;
  if (body)
    equator = pl_celestial_equator(body, day, fraction);
  return pl_py_check(pl_j2_create(&orbit, flattening, osculating != 0, frame, equator, out), where);
}

static int read_table(PyObject *spec, const char *where, double day, double fraction,
                      pl_propagator **out) {
  (void)day, (void)fraction;
  size_t degree = 0;
  if (pl_py_member_size(spec, "degree", where, &degree) < 0)
    return -1;
  const npy_intp any[2] = {-1, -1};
  PyArrayObject *times = pl_py_member_array(spec, "t_s", where, 1, any);
  PyArrayObject *states = times ? pl_py_member_array(spec, "states", where, 2, any) : NULL;
  int result = states ? 0 : -1;
  if (result == 0) {
    const npy_intp count = PyArray_SIZE(times), columns = PyArray_DIM(states, 1);
    if (PyArray_DIM(states, 0) != count || (columns != 3 && columns != 6)) {
      PyErr_Format(PyExc_ValueError,
                   "%s: states: shape must be (%zd, 3) or (%zd, 6), not (%zd, %zd)", where,
                   (Py_ssize_t)count, (Py_ssize_t)count, (Py_ssize_t)PyArray_DIM(states, 0),
                   (Py_ssize_t)columns);
      result = -1;
    } else {
      const pl_table_rows rows = {(size_t)count, PyArray_DATA(times), PyArray_DATA(states),
                                  columns == 6};
      const int most = degree > PL_TABLE_MAX_DEGREE ? PL_TABLE_MAX_DEGREE + 1 : (int)degree;
      result = pl_py_check(pl_table_create(&rows, most, out), where);
    }
  }
  Py_XDECREF((PyObject *)times);
  Py_XDECREF((PyObject *)states);
  return result;
}

static const struct {
  const pl_propagator_kind *kind;
  pl_py_propagator_reader read;
} readers[] = {
    {&pl_kepler_kind, read_kepler},
    {&pl_circular_kind, read_circular},
    {&pl_j2_kind, read_j2},
    {&pl_table_kind, read_table},
    {&pl_numerical_kind, pl_py_read_numerical},
};
#define READER_COUNT (sizeof readers / sizeof readers[0])

int pl_py_read_propagator(PyObject *spec, const char *where, double day, double fraction,
                          pl_propagator **out) {
  const char *names[READER_COUNT];
  for (size_t i = 0; i < READER_COUNT; i++)
    names[i] = readers[i].kind->name;
  const int kind =
      pl_py_member_choice(spec, "kind", where ? where : "propagator", names, (int)READER_COUNT);
  /* Forces of a propagator may refer to propagators, so a description may contain itself. */
  if (kind < 0 || Py_EnterRecursiveCall(" in the description of a propagator"))
    return -1;
  const int result = readers[kind].read(spec, where ? where : names[kind], day, fraction, out);
  Py_LeaveRecursiveCall();
  return result;
}

typedef struct propagator_object {
  PyObject_HEAD pl_propagator *propagator; /* owned */
  double day, fraction;
} propagator_object;

static void propagator_dealloc(PyObject *self) {
  PyTypeObject *type = Py_TYPE(self);
  pl_propagator_destroy(((propagator_object *)self)->propagator);
  ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
  Py_DECREF(type);
}

const pl_propagator *pl_py_propagator_of(PyObject *object, double *day, double *fraction) {
  if (!pl_py_is(object, (void *)propagator_dealloc)) {
    PyErr_SetString(PyExc_TypeError, "must be a perilune._core.Propagator");
    return NULL;
  }
  const propagator_object *self = (propagator_object *)object;
  *day = self->day;
  *fraction = self->fraction;
  return self->propagator;
}

static PyObject *propagator_new(PyTypeObject *type, PyObject *args, PyObject *kwargs) {
  static char *keywords[] = {"spec", "tdb_day", "tdb_fraction", NULL};
  PyObject *spec = NULL;
  double day = 0.0, fraction = 0.0;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "Odd:Propagator", keywords, &spec, &day,
                                   &fraction))
    return NULL;
  if (!isfinite(day) || !isfinite(fraction)) {
    PyErr_SetString(PyExc_ValueError, "tdb_day or tdb_fraction is not finite");
    return NULL;
  }
  propagator_object *self =
      (propagator_object *)((allocfunc)PyType_GetSlot(type, Py_tp_alloc))(type, 0);
  if (!self)
    return NULL;
  self->day = day;
  self->fraction = fraction;
  if (pl_py_read_propagator(spec, NULL, day, fraction, &self->propagator) < 0)
    Py_CLEAR(self);
  return (PyObject *)self;
}

static PyObject *propagator_states(PyObject *self, PyObject *time_object) {
  PyArrayObject *times = pl_py_doubles(time_object, "t_s");
  if (!times)
    return NULL;
  npy_intp shape[2] = {PyArray_SIZE(times), 6};
  PyObject *out = PyArray_SimpleNew(2, shape, NPY_DOUBLE);
  pl_status status = PL_OK;
  if (out) {
    const pl_propagator *propagator = ((propagator_object *)self)->propagator;
    const double *t_s = PyArray_DATA(times);
    pl_state *states = PyArray_DATA((PyArrayObject *)out);
    Py_BEGIN_ALLOW_THREADS status = pl_propagator_states(propagator, (size_t)shape[0], t_s, states);
    Py_END_ALLOW_THREADS
  }
  Py_DECREF(times);
  if (status == PL_OK)
    return out;
  Py_XDECREF(out);
  return pl_py_raise(status);
}

static PyObject *get_kind(PyObject *self, void *closure) {
  (void)closure;
  return PyUnicode_FromString(((propagator_object *)self)->propagator->kind->name);
}

static PyGetSetDef propagator_getset[] = {
    {"kind", get_kind, NULL, "Name of its kind, as in PROPAGATORS.", NULL},
    {NULL, NULL, NULL, NULL, NULL},
};

static PyMethodDef propagator_methods[] = {
    {"states", propagator_states, METH_O,
     "states($self, t_s, /)\n--\n\n"
     "(n, 6) position m and velocity m/s about the parent, ICRF axes, at seconds t_s (n,) after\n"
     "the epoch. Releases the GIL."},
    {NULL, NULL, 0, NULL},
};

static PyType_Slot propagator_slots[] = {
    {Py_tp_doc,
     "Propagator(spec, tdb_day, tdb_fraction)\n--\n\n"
     "A path about a parent from the epoch JD(TDB) = tdb_day + tdb_fraction; immutable."},
    {Py_tp_new, (void *)propagator_new},
    {Py_tp_dealloc, (void *)propagator_dealloc},
    {Py_tp_getset, propagator_getset},
    {Py_tp_methods, propagator_methods},
    {0, NULL},
};

PyType_Spec pl_py_propagator_spec = {"perilune._core.Propagator", sizeof(propagator_object), 0,
                                     Py_TPFLAGS_DEFAULT, propagator_slots};
