/* Parses the volumes of a request. */
#include "pyext/py_request.h"

#include <string.h>

#include "base/memory.h"
#include "pyext/py_read.h"
#include "pyext/py_types.h"

enum { WHERE_LENGTH = 96 };

/* Copies the parameters of a graph, (n, 3) with as many rows as it has. `out` must have room for
 * `count` values. */
static int copy_parameters(PyObject *given, const char *where, size_t count, pl_value *out) {
  const npy_intp shape[2] = {(npy_intp)count, 3};
  if (count == 0)
    return 0;
  PyArrayObject *array = pl_py_member_array(given, "parameters", where, 2, shape);
  if (array == NULL)
    return -1;
  const double *from = PyArray_DATA(array);
  for (size_t i = 0; i < count; i++)
    for (size_t k = 0; k < 4; k++)
      out[i][k] = k < 3 ? (float)from[3 * i + k] : 0.0f;
  Py_DECREF((PyObject *)array);
  return 0;
}

static int parse_material(PyObject *given, const char *where, PyObject *kept, pl_volume *out) {
  PyObject *graph;
  if (pl_py_member(given, "graph", 1, where, &graph) < 0)
    return -1;
  if (graph != Py_None)
    out->graph = pl_py_graph_of(graph);
  const int failed = (graph != Py_None && out->graph == NULL) || PyList_Append(kept, graph) < 0;
  Py_DECREF(graph);
  return failed ? -1 : 0;
}

static int parse_bound(PyObject *given, const char *where, pl_volume *out) {
  enum { NAMES = 8 };
  const char *names[NAMES];
  int count = 0;
  for (; count < (int)pl_bound_count && count < NAMES; count++)
    names[count] = pl_bounds[count]->name;
  const int shape = pl_py_member_choice(given, "shape", where, names, count);
  if (shape < 0)
    return -1;
  out->bound = pl_bounds[shape];
  return pl_py_member_doubles(given, "size_m", where, 3, out->size);
}

static void to_floats(const double from[3], float to[3]) {
  for (int k = 0; k < 3; k++)
    to[k] = (float)from[k];
}

static int parse_volume(PyObject *given, PyObject *kept, pl_volume *out) {
  PyObject *owner;
  const char *name;
  char where[WHERE_LENGTH];
  double pose[7], extinction[3], albedo[3], emission[3], g;
  *out = (pl_volume){0};
  if (pl_py_member_text(given, "name", "volumes", &owner, &name) < 0)
    return -1;
  const int failed = PyList_Append(kept, owner);
  Py_DECREF(owner);
  PyOS_snprintf(where, sizeof where, "volume '%.60s'", name);
  if (failed || parse_bound(given, where, out) < 0 ||
      pl_py_member_size(given, "parent", where, &out->parent) < 0 ||
      pl_py_member_doubles(given, "pose", where, 7, pose) < 0 ||
      pl_py_member_doubles(given, "extinction_per_m", where, 3, extinction) < 0 ||
      pl_py_member_doubles(given, "albedo", where, 3, albedo) < 0 ||
      pl_py_member_doubles(given, "emission", where, 3, emission) < 0 ||
      pl_py_member_double(given, "g", where, &g) < 0 ||
      pl_py_member_double(given, "core_m", where, &out->core_m) < 0 ||
      parse_material(given, where, kept, out) < 0)
    return -1;
  out->name = name;
  out->random = pl_material_random(name);
  out->local = (pl_pose){{pose[0], pose[1], pose[2]}, {pose[3], pose[4], pose[5], pose[6]}};
  out->g = (float)g;
  to_floats(extinction, out->extinction);
  to_floats(albedo, out->albedo);
  to_floats(emission, out->emission);
  return 0;
}

/* Called after all volumes are read: their parameters are then allocated at once and do not move
 * any more. */
static int parse_parameters(PyObject *list, pl_py_states *states, size_t count) {
  size_t total = 0;
  for (size_t i = 0; i < count; i++)
    total +=
        states->volumes[i].graph != NULL ? pl_graph_parameter_count(states->volumes[i].graph) : 0;
  if (total > states->volume_room) {
    pl_value *grown = pl_realloc(states->volume_parameters, total, sizeof *grown);
    if (grown == NULL)
      return PyErr_NoMemory(), -1;
    states->volume_parameters = grown;
    states->volume_room = total;
  }
  pl_value *next = states->volume_parameters;
  for (size_t i = 0; i < count; i++) {
    pl_volume *volume = &states->volumes[i];
    const size_t own = volume->graph != NULL ? pl_graph_parameter_count(volume->graph) : 0;
    if (own == 0)
      continue;
    volume->parameters = next;
    PyObject *given = PySequence_GetItem(list, (Py_ssize_t)i);
    const int failed = given == NULL || copy_parameters(given, volume->name, own, next) < 0;
    Py_XDECREF(given);
    if (failed)
      return -1;
    next += own;
  }
  return 0;
}

static int parse_list(PyObject *list, PyObject *request, pl_py_states *states,
                      pl_frame_request *out) {
  PyObject *quality = NULL;
  const Py_ssize_t count = PySequence_Size(list);
  size_t steps = 0;
  if (count < 0)
    return -1;
  if (count > PL_VOLUMES_MAX) {
    PyErr_Format(PyExc_ValueError, "%zd volumes: there may be %d", count, (int)PL_VOLUMES_MAX);
    return -1;
  }
  if (count == 0)
    return 0;
  for (Py_ssize_t i = 0; i < count; i++) {
    PyObject *given = PySequence_GetItem(list, i);
    const int failed = given == NULL || parse_volume(given, states->kept, &states->volumes[i]) < 0;
    Py_XDECREF(given);
    if (failed)
      return -1;
  }
  if (parse_parameters(list, states, (size_t)count) < 0 ||
      pl_py_member(request, "quality", 0, "request", &quality) < 0)
    return -1;
  const int failed = pl_py_member_size(quality, "volume_steps", "quality", &steps);
  Py_DECREF(quality);
  out->volume_steps = steps <= 4096 ? (int)steps : -1;
  out->placement.volumes = states->volumes;
  out->placement.volume_count = (size_t)count;
  return failed;
}

int pl_py_volumes_parse(PyObject *request, pl_py_states *states, pl_frame_request *out) {
  PyObject *given;
  out->placement.volumes = NULL;
  out->placement.volume_count = 0;
  if (pl_py_member(request, "volumes", 1, "request", &given) < 0)
    return -1;
  const int failed = given != Py_None ? parse_list(given, request, states, out) : 0;
  Py_DECREF(given);
  return failed;
}
