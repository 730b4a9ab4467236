/* The type Articulation: joints and animations of a model. */
#include "pyext/py_types.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "geom/articulation.h"
#include "pyext/py_read.h"

typedef struct articulation_object {
  PyObject_HEAD PyObject *model; /* Model */
  pl_articulation *core;         /* owned */
  pl_affine *motions;            /* owned: buffer for one pose; the GIL guards it */
  Py_ssize_t joints;
} articulation_object;

static void articulation_dealloc(PyObject *object) {
  articulation_object *self = (articulation_object *)object;
  PyTypeObject *type = Py_TYPE(object);
  pl_articulation_destroy(self->core);
  pl_free(self->motions);
  Py_XDECREF(self->model);
  ((freefunc)PyType_GetSlot(type, Py_tp_free))(object);
  Py_DECREF(type);
}

static pl_vec3 vec_of(const double v[3]) { return (pl_vec3){v[0], v[1], v[2]}; }

static int read_joint(PyObject *item, pl_joint *out) {
  static const char *const kinds[] = {"turn", "slide", "towards"};
  const char *where = "joint";
  double axis[3], pivot[3] = {0.0, 0.0, 0.0}, normal[3] = {0.0, 0.0, 0.0};
  size_t node;
  PyObject *own;
  const int kind = pl_py_member_choice(item, "kind", where, kinds, 3);
  if (kind < 0 || pl_py_member_size(item, "node", where, &node) < 0 ||
      pl_py_member_doubles(item, "axis", where, 3, axis) < 0 ||
      pl_py_optional_doubles(item, "pivot", where, 3, pivot) < 0 ||
      pl_py_optional_doubles(item, "normal", where, 3, normal) < 0 ||
      pl_py_member(item, "in_node_axes", 0, where, &own) < 0)
    return -1;
  *out = (pl_joint){.node = node > INT32_MAX ? -1 : (int)node,
                    .kind = (pl_joint_kind)kind,
                    .axis = vec_of(axis),
                    .pivot = vec_of(pivot),
                    .normal = vec_of(normal),
                    .in_node_axes = own == Py_True};
  Py_DECREF(own);
  return 0;
}

/* Returns an array of `count` joints; the caller frees it. */
static pl_joint *read_joints(PyObject *list, Py_ssize_t count) {
  pl_joint *joints = pl_alloc((size_t)count, sizeof *joints);
  if (joints == NULL)
    return (pl_joint *)PyErr_NoMemory();
  for (Py_ssize_t i = 0; i < count; i++) {
    PyObject *item = PySequence_GetItem(list, i);
    const int failed = item == NULL || read_joint(item, &joints[i]) < 0;
    Py_XDECREF(item);
    if (failed) {
      pl_free(joints);
      return NULL;
    }
  }
  return joints;
}

static pl_status make_room(articulation_object *self) {
  const int *nodes;
  void *motions;
  PL_TRY(pl_alloc_or_fail(pl_articulation_nodes(self->core, &nodes), sizeof(pl_affine), "motions",
                          &motions));
  self->motions = motions;
  return PL_OK;
}

static int create(articulation_object *self, const pl_model *model, PyObject *list,
                  PyArrayObject *animations) {
  self->joints = PySequence_Size(list);
  pl_joint *joints = self->joints >= 0 ? read_joints(list, self->joints) : NULL;
  if (joints == NULL)
    return -1;
  pl_status status =
      pl_articulation_create(model, joints, (size_t)self->joints, PyArray_DATA(animations),
                             (size_t)PyArray_DIM(animations, 0), &self->core);
  pl_free(joints);
  if (status == PL_OK)
    status = make_room(self);
  if (status != PL_OK)
    pl_py_raise(status);
  return status == PL_OK ? 0 : -1;
}

static int fill(articulation_object *self, PyObject *model, PyObject *list, PyObject *animations) {
  const npy_intp any[1] = {-1};
  const pl_model *core = pl_py_model_of(model);
  PyArrayObject *array =
      core != NULL ? pl_py_array(animations, "animations", NPY_INT, 1, any) : NULL;
  const int failed = array == NULL || create(self, core, list, array) < 0;
  Py_XDECREF((PyObject *)array);
  if (!failed)
    self->model = Py_NewRef(model);
  return failed ? -1 : 0;
}

static PyObject *articulation_new(PyTypeObject *type, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"model", "joints", "animations", NULL};
  PyObject *model, *joints, *animations;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OOO:Articulation", names, &model, &joints,
                                   &animations))
    return NULL;
  articulation_object *self =
      (articulation_object *)((allocfunc)PyType_GetSlot(type, Py_tp_alloc))(type, 0);
  if (self != NULL && fill(self, model, joints, animations) < 0)
    Py_CLEAR(self);
  return (PyObject *)self;
}

static PyObject *get_nodes(PyObject *object, void *closure) {
  (void)closure;
  const int *nodes;
  const size_t count = pl_articulation_nodes(((articulation_object *)object)->core, &nodes);
  PyObject *tuple = PyTuple_New((Py_ssize_t)count);
  for (size_t i = 0; tuple != NULL && i < count; i++) {
    PyObject *number = PyLong_FromLong(nodes[i]);
    if (number == NULL)
      Py_CLEAR(tuple);
    else
      PyTuple_SetItem(tuple, (Py_ssize_t)i, number);
  }
  return tuple;
}

static PyObject *get_axes(PyObject *object, void *closure) {
  (void)closure;
  const pl_joint *joints;
  const size_t count = pl_articulation_joints(((articulation_object *)object)->core, &joints);
  npy_intp shape[3] = {(npy_intp)count, 2, 3};
  PyObject *array = PyArray_SimpleNew(3, shape, NPY_DOUBLE);
  double *out = array != NULL ? PyArray_DATA((PyArrayObject *)array) : NULL;
  for (size_t i = 0; out != NULL && i < count; i++) {
    const pl_vec3 a = joints[i].axis, p = joints[i].pivot;
    const double values[6] = {a.x, a.y, a.z, p.x, p.y, p.z};
    memcpy(out + 6 * i, values, sizeof values);
  }
  return array;
}

static int loop_of(const char *name) {
  static const char *const names[] = {"repeat", "clamp", "pingpong"};
  for (int i = 0; i < 3; i++)
    if (strcmp(name, names[i]) == 0)
      return i;
  PyErr_Format(PyExc_ValueError, "loop is '%s'; allowed: repeat, clamp, pingpong", name);
  return -1;
}

/* Returns motions as an array of 3 x 4 matrices. */
static PyObject *motions_array(const pl_affine *motions, size_t count) {
  npy_intp shape[3] = {(npy_intp)count, 3, 4};
  PyObject *array = PyArray_SimpleNew(3, shape, NPY_DOUBLE);
  double *out = array != NULL ? PyArray_DATA((PyArrayObject *)array) : NULL;
  for (size_t i = 0; out != NULL && i < count; i++) {
    const double t[3] = {motions[i].t.x, motions[i].t.y, motions[i].t.z};
    for (int row = 0; row < 3; row++) {
      const pl_vec3 m = motions[i].m.row[row];
      const double values[4] = {m.x, m.y, m.z, t[row]};
      memcpy(out, values, sizeof values);
      out += 4;
    }
  }
  return array;
}

static PyObject *pose(articulation_object *self, PyArrayObject *values, PyArrayObject *targets,
                      double play_s, pl_loop loop) {
  const int *nodes;
  const size_t count = pl_articulation_nodes(self->core, &nodes);
  npy_intp joints[1] = {self->joints};
  PyObject *reached = PyArray_SimpleNew(1, joints, NPY_DOUBLE);
  if (reached == NULL)
    return NULL;
  pl_articulation_pose(self->core, PyArray_DATA(values), PyArray_DATA(targets), play_s, loop,
                       PyArray_DATA((PyArrayObject *)reached), self->motions);
  PyObject *array = motions_array(self->motions, count);
  if (array != NULL)
    return Py_BuildValue("(NN)", reached, array);
  Py_DECREF(reached);
  return NULL;
}

static PyObject *articulation_pose(PyObject *object, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"values", "targets", "play_s", "loop", NULL};
  articulation_object *self = (articulation_object *)object;
  const npy_intp shape[2] = {self->joints, 3};
  PyObject *values, *targets, *result = NULL;
  double play_s = 0.0;
  const char *loop = "repeat";
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OO|ds:pose", names, &values, &targets, &play_s,
                                   &loop))
    return NULL;
  const int kind = loop_of(loop);
  if (kind < 0)
    return NULL;
  if (!isfinite(play_s))
    return PyErr_Format(PyExc_ValueError, "play_s must be finite");
  PyArrayObject *a = pl_py_array(values, "values", NPY_DOUBLE, 1, shape);
  PyArrayObject *b = a != NULL ? pl_py_array(targets, "targets", NPY_DOUBLE, 2, shape) : NULL;
  if (b != NULL)
    result = pose(self, a, b, play_s, (pl_loop)kind);
  Py_XDECREF((PyObject *)a);
  Py_XDECREF((PyObject *)b);
  return result;
}

static PyGetSetDef articulation_getset[] = {
    {"nodes", get_nodes, NULL, "Indices of the moving nodes, parents before children.", NULL},
    {"axes", get_axes, NULL, "(joints, 2, 3): unit axis and pivot, model axes.", NULL},
    {NULL, NULL, NULL, NULL, NULL},
};

static PyMethodDef articulation_methods[] = {
    {"pose", (PyCFunction)(void (*)(void))articulation_pose, METH_VARARGS | METH_KEYWORDS,
     "The joints' angles or ways, and the motion of each moving node."},
    {NULL, NULL, 0, NULL},
};

static PyType_Slot articulation_slots[] = {
    {Py_tp_doc, "Articulation(model, joints, animations)\n--\n\nMoving nodes of a model."},
    {Py_tp_new, (void *)articulation_new},
    {Py_tp_dealloc, (void *)articulation_dealloc},
    {Py_tp_getset, articulation_getset},
    {Py_tp_methods, articulation_methods},
    {0, NULL},
};

PyType_Spec pl_py_articulation_spec = {"perilune._core.Articulation", sizeof(articulation_object),
                                       0, Py_TPFLAGS_DEFAULT, articulation_slots};
