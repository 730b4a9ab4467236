/* "part_groups" of the request dictionary. */
#include "base/memory.h"
#include "pyext/py_read.h"
#include "pyext/py_request.h"
#include "pyext/py_types.h"

static int make_room(pl_py_states *states, size_t count) {
  if (count <= states->group_room)
    return 0;
  pl_part_group *grown = pl_realloc(states->groups, count, sizeof *grown);
  if (grown == NULL)
    return PyErr_NoMemory(), -1;
  states->groups = grown;
  states->group_room = count;
  return 0;
}

/* Each group has a flag for each part of its object, one group after the other. */
static int take(const pl_scene *scene, PyArrayObject *objects, PyArrayObject *flags,
                pl_py_states *states, pl_frame_request *out) {
  const size_t count = (size_t)PyArray_DIM(objects, 0), given = (size_t)PyArray_DIM(flags, 0);
  const int32_t *object = PyArray_DATA(objects);
  size_t used = 0;
  if (make_room(states, count) < 0)
    return -1;
  for (size_t i = 0; i < count; i++) {
    const bool known = object[i] >= 0 && (size_t)object[i] < scene->craft_count;
    const size_t parts = known ? scene->objects[object[i]].part_count : 0;
    if (!known || parts > given - used) {
      PyErr_Format(PyExc_ValueError, "part_groups: group %zu has no such object, or lacks flags",
                   i);
      return -1;
    }
    states->groups[i] = (pl_part_group){.object = (size_t)object[i],
                                        .parts = (const uint8_t *)PyArray_DATA(flags) + used};
    used += parts;
  }
  out->groups = states->groups;
  out->group_count = count;
  return 0;
}

int pl_py_part_groups_parse(PyObject *request, const pl_scene *scene, pl_py_states *states,
                            pl_frame_request *out) {
  const npy_intp any[1] = {-1};
  PyObject *given, *of, *which;
  if (pl_py_member(request, "part_groups", 1, "request", &given) < 0)
    return -1;
  int failed = 0;
  if (given != Py_None && (!PyTuple_Check(given) || !PyArg_ParseTuple(given, "OO", &of, &which))) {
    PyErr_SetString(PyExc_TypeError, "part_groups: (objects, flags), or None");
    failed = 1;
  } else if (given != Py_None) {
    PyArrayObject *objects = pl_py_array(of, "part_groups", NPY_INT32, 1, any);
    PyArrayObject *flags =
        objects != NULL ? pl_py_array(which, "part_groups", NPY_UINT8, 1, any) : NULL;
    failed = flags == NULL || pl_py_keep_memory(states->kept, (PyObject *)flags) < 0 ||
             take(scene, objects, flags, states, out) < 0;
    Py_XDECREF((PyObject *)objects);
    Py_XDECREF((PyObject *)flags);
  }
  Py_DECREF(given);
  return failed ? -1 : 0;
}
