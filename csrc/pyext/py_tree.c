/* Reads trees of nodes from sequences of mappings and returns their states as arrays. */
#include "pyext/py_tree.h"

#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "orbit/tree.h"
#include "pyext/py_propagator.h"
#include "pyext/py_read.h"
#include "pyext/py_types.h"

#define WHERE_SIZE 160

typedef struct tree_object {
  PyObject_HEAD pl_tree *tree; /* owned */
  PyObject *kept;              /* list: names and propagators that the tree borrows */
  Py_ssize_t count;
  double day, fraction;
} tree_object;

static int read_path(PyObject *motion, const char *where, tree_object *self, pl_path *out) {
  static const char *const kinds[] = {"fixed", "given"};
  if (!PyMapping_Check(motion)) {
    double day, fraction;
    out->kind = PL_PATH_PROPAGATED;
    out->propagator = pl_py_propagator_of(motion, &day, &fraction);
    if (!out->propagator)
      return pl_py_prefix_error(where);
    if (day != self->day || fraction != self->fraction) {
      PyErr_Format(PyExc_ValueError, "%s: the propagator's epoch is not the tree's", where);
      return -1;
    }
    return PyList_Append(self->kept, motion);
  }
  const int kind = pl_py_member_choice(motion, "kind", where, kinds, 2);
  if (kind < 0)
    return -1;
  out->kind = kind == 0 ? PL_PATH_FIXED : PL_PATH_GIVEN;
  if (out->kind == PL_PATH_GIVEN)
    return pl_py_member_size(motion, "slot", where, &out->slot);
  return pl_py_member_doubles(motion, "position_m", where, 3, &out->position_m.x);
}

/* Reads mapping[key]: a node's index into *towards, or a direction. */
static int read_aim(PyObject *rotation, const char *key, const char *where, pl_turn *out) {
  PyObject *item = NULL;
  if (pl_py_member(rotation, key, 0, where, &item) < 0)
    return -1;
  out->towards = -1;
  int result = 0;
  if (PyLong_Check(item)) {
    size_t index = 0;
    result = pl_py_member_size(rotation, key, where, &index);
    out->towards = (ptrdiff_t)index;
  } else {
    result = pl_py_member_doubles(rotation, key, where, 3, &out->direction.x);
  }
  Py_DECREF(item);
  return result < 0 ? -1 : pl_py_optional_doubles(rotation, "up", where, 3, &out->up.x);
}

static int read_tumble(PyObject *rotation, const char *where, pl_tumble *out) {
  pl_vec3 inertia, omega;
  pl_quat start = PL_QUAT_IDENTITY;
  if (pl_py_member_doubles(rotation, "inertia", where, 3, &inertia.x) < 0 ||
      pl_py_member_doubles(rotation, "omega_rad_s", where, 3, &omega.x) < 0 ||
      pl_py_optional_doubles(rotation, "start", where, 4, &start.w) < 0)
    return -1;
  return pl_py_check(pl_tumble_init(inertia, omega, start, out), where);
}

/* The arrays are copies and are kept alive by the tree. */
static int read_table(PyObject *rotation, const char *where, tree_object *self,
                      pl_attitude_table *out) {
  const npy_intp any[1] = {-1};
  PyArrayObject *times = pl_py_member_array(rotation, "t_s", where, 1, any);
  const npy_intp shape[2] = {times ? PyArray_SIZE(times) : 0, 4};
  PyArrayObject *quats = times ? pl_py_member_array(rotation, "quats", where, 2, shape) : NULL;
  int result = -1;
  if (quats && PyList_Append(self->kept, (PyObject *)times) == 0)
    result = PyList_Append(self->kept, (PyObject *)quats);
  if (result == 0)
    *out = (pl_attitude_table){(size_t)shape[0], PyArray_DATA(times), PyArray_DATA(quats)};
  Py_XDECREF((PyObject *)times);
  Py_XDECREF((PyObject *)quats);
  return result;
}

static int read_turn(PyObject *rotation, const char *where, tree_object *self, pl_turn *out) {
  *out = PL_TURN_NONE;
  PyObject *owner = NULL;
  const char *frame = NULL;
  if (pl_py_member_text(rotation, "frame", where, &owner, &frame) < 0)
    return -1;
  const int known = pl_py_check(pl_turn_require(frame, &out->kind), where);
  Py_DECREF(owner);
  if (known < 0)
    return -1;
  const unsigned needs = out->kind->needs;
  if ((needs & PL_TURN_BODY) && pl_py_read_celestial(rotation, "body", 0, where, &out->body) < 0)
    return -1;
  if ((needs & PL_TURN_AIM) && read_aim(rotation, "towards", where, out) < 0)
    return -1;
  if ((needs & PL_TURN_GIVEN) && pl_py_member_size(rotation, "slot", where, &out->slot) < 0)
    return -1;
  if ((needs & PL_TURN_TUMBLE) && read_tumble(rotation, where, &out->tumble) < 0)
    return -1;
  if ((needs & PL_TURN_TABLE) && read_table(rotation, where, self, &out->table) < 0)
    return -1;
  if (pl_py_optional_doubles(rotation, "q", where, 4, &out->q.w) < 0 ||
      pl_py_optional_doubles(rotation, "axis", where, 3, &out->axis.x) < 0)
    return -1;
  return pl_py_optional_double(rotation, "rate_rad_s", where, &out->rate_rad_s);
}

/* Reads one node; errors name its index. */
static int read_node(PyObject *item, Py_ssize_t index, tree_object *self, pl_tree_node *out) {
  char where[WHERE_SIZE];
  snprintf(where, sizeof where, "nodes[%zd]", index);
  PyObject *part = NULL;
  if (pl_py_member_text(item, "name", where, &part, &out->name) < 0)
    return -1;
  int result = PyList_Append(self->kept, part);
  Py_DECREF(part);
  if (result < 0 || pl_py_member(item, "parent", 0, where, &part) < 0)
    return -1;
  out->parent = PyLong_AsSsize_t(part);
  Py_DECREF(part);
  if (PyErr_Occurred()) {
    pl_py_prefix_error("parent");
    return pl_py_prefix_error(where);
  }
  snprintf(where, sizeof where, "node '%.100s': motion", out->name);
  if (pl_py_member(item, "motion", 0, where, &part) < 0)
    return -1;
  result = read_path(part, where, self, &out->path);
  Py_DECREF(part);
  snprintf(where, sizeof where, "node '%.100s': rotation", out->name);
  if (result < 0 || pl_py_member(item, "rotation", 0, where, &part) < 0)
    return -1;
  result = read_turn(part, where, self, &out->turn);
  Py_DECREF(part);
  return result;
}

static int read_tree(PyObject *sequence, tree_object *self) {
  pl_tree_node *nodes = pl_alloc((size_t)self->count, sizeof *nodes);
  if (!nodes) {
    PyErr_NoMemory();
    return -1;
  }
  int result = 0;
  for (Py_ssize_t i = 0; i < self->count && result == 0; i++) {
    PyObject *item = PySequence_GetItem(sequence, i);
    result = item ? read_node(item, i, self, &nodes[i]) : -1;
    Py_XDECREF(item);
  }
  if (result == 0) {
    const pl_status status =
        pl_tree_create((size_t)self->count, nodes, self->day, self->fraction, &self->tree);
    if (status != PL_OK) {
      pl_py_raise(status);
      result = -1;
    }
  }
  pl_free(nodes);
  return result;
}

static void tree_dealloc(PyObject *self) {
  PyTypeObject *type = Py_TYPE(self);
  pl_tree_destroy(((tree_object *)self)->tree);
  Py_XDECREF(((tree_object *)self)->kept);
  ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
  Py_DECREF(type);
}

static PyObject *tree_new(PyTypeObject *type, PyObject *args, PyObject *kwargs) {
  static char *keywords[] = {"nodes", "tdb_day", "tdb_fraction", NULL};
  PyObject *nodes = NULL;
  double day = 0.0, fraction = 0.0;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "Odd:Tree", keywords, &nodes, &day, &fraction))
    return NULL;
  const Py_ssize_t count = PySequence_Size(nodes);
  if (count < 0)
    return NULL;
  tree_object *self = (tree_object *)((allocfunc)PyType_GetSlot(type, Py_tp_alloc))(type, 0);
  if (!self)
    return NULL;
  self->count = count;
  self->day = day;
  self->fraction = fraction;
  self->kept = PyList_New(0);
  if (!self->kept || read_tree(nodes, self) < 0)
    Py_CLEAR(self);
  return (PyObject *)self;
}

/* Reads states given by the caller: (times, slots, columns), or NULL for None, with *slots 0. */
static int read_given(PyObject *object, const char *name, npy_intp times, npy_intp columns,
                      PyArrayObject **out, size_t *slots) {
  const npy_intp shape[3] = {times, -1, columns};
  *out = NULL;
  *slots = 0;
  if (object == Py_None)
    return 0;
  *out = pl_py_array(object, name, NPY_DOUBLE, 3, shape);
  if (!*out)
    return -1;
  *slots = (size_t)PyArray_DIM(*out, 1);
  return 0;
}

static PyObject *evaluate(const tree_object *self, PyArrayObject *times,
                          const pl_tree_given *given) {
  const npy_intp n = PyArray_SIZE(times);
  npy_intp poses[3] = {n, self->count, 7}, velocities[3] = {n, self->count, 3};
  npy_intp relative[3] = {self->count, n, 6};
  PyObject *arrays[3] = {PyArray_SimpleNew(3, poses, NPY_DOUBLE),
                         PyArray_SimpleNew(3, velocities, NPY_DOUBLE),
                         PyArray_SimpleNew(3, relative, NPY_DOUBLE)};
  PyObject *result = NULL;
  if (arrays[0] && arrays[1] && arrays[2]) {
    const pl_tree_states out = {PyArray_DATA((PyArrayObject *)arrays[0]),
                                PyArray_DATA((PyArrayObject *)arrays[1]),
                                PyArray_DATA((PyArrayObject *)arrays[2])};
    const double *t_s = PyArray_DATA(times);
    pl_status status;
    Py_BEGIN_ALLOW_THREADS status = pl_tree_evaluate(self->tree, (size_t)n, t_s, given, &out);
    Py_END_ALLOW_THREADS result =
        status == PL_OK ? PyTuple_Pack(2, arrays[0], arrays[1]) : pl_py_raise(status);
  }
  for (int i = 0; i < 3; i++)
    Py_XDECREF(arrays[i]);
  return result;
}

static PyObject *tree_states(PyObject *self, PyObject *args, PyObject *kwargs) {
  static char *keywords[] = {"t_s", "given", "given_q", NULL};
  PyObject *time_object = NULL, *state_object = Py_None, *quat_object = Py_None;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O|OO:states", keywords, &time_object,
                                   &state_object, &quat_object))
    return NULL;
  PyArrayObject *times = pl_py_doubles(time_object, "t_s"), *states = NULL, *quats = NULL;
  if (!times)
    return NULL;
  PyObject *result = NULL;
  pl_tree_given given = {0};
  const npy_intp n = PyArray_SIZE(times);
  if (read_given(state_object, "given", n, 6, &states, &given.state_slots) == 0 &&
      read_given(quat_object, "given_q", n, 4, &quats, &given.quat_slots) == 0) {
    given.states = states ? PyArray_DATA(states) : NULL;
    given.quats = quats ? PyArray_DATA(quats) : NULL;
    result = evaluate((tree_object *)self, times, &given);
  }
  Py_XDECREF((PyObject *)states);
  Py_XDECREF((PyObject *)quats);
  Py_DECREF((PyObject *)times);
  return result;
}

static PyMethodDef tree_methods[] = {
    {"states", (PyCFunction)(void (*)(void))tree_states, METH_VARARGS | METH_KEYWORDS,
     "states($self, t_s, given=None, given_q=None)\n--\n\n"
     "Poses (n, nodes, 7) in the root frame and velocities (n, nodes, 3), m/s in the root frame,\n"
     "at seconds t_s (n,) after the epoch. given (n, slots, 6): states of the nodes whose motion\n"
     "is given; given_q (n, slots, 4): axes of those whose rotation is. Releases the GIL."},
    {NULL, NULL, 0, NULL},
};

static PyType_Slot tree_slots[] = {
    {Py_tp_doc, "Tree(nodes, tdb_day, tdb_fraction)\n--\n\n"
                "Bodies and objects that move about each other and turn; immutable."},
    {Py_tp_new, (void *)tree_new},
    {Py_tp_dealloc, (void *)tree_dealloc},
    {Py_tp_methods, tree_methods},
    {0, NULL},
};

PyType_Spec pl_py_tree_spec = {"perilune._core.Tree", sizeof(tree_object), 0, Py_TPFLAGS_DEFAULT,
                               tree_slots};
