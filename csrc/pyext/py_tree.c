/* Nodes from mappings, and their poses as an array. */
#include "pyext/py_tree.h"

#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "orbit/elements.h"
#include "orbit/tree.h"
#include "pyext/py_read.h"

#define WHERE_SIZE 160

const char pl_py_tree_poses_doc[] =
    "tree_poses($module, nodes, tdb_day, tdb_fraction, t_s)\n--\n\n"
    "Poses (n_times, n_nodes, 7) of a tree of bodies and objects in the root frame.\n\n"
    "Each node: {'name': str, 'parent': index or -1, 'motion': M, 'rotation': R}, any order.\n"
    "M: {'kind': 'fixed', 'position_m': (3,)} or {'kind': 'kepler', 'gm': float,\n"
    "    'elements': {...}, 'frame': 'icrf' | 'equator', 'parent_body': name or None}\n"
    "R: {'kind': 'fixed', 'q': (4,)} | {'kind': 'spin', 'q': (4,), 'axis': (3,),\n"
    "    'rate_rad_s': float} | {'kind': 'body', 'body': name} | {'kind': 'lvlh'}";

/* Sets the exception of `status`, prefixed; returns -1. */
static int fail_at(const char *where, pl_status status) {
  pl_py_raise(status);
  return pl_py_prefix_error(where);
}

int pl_py_read_orbit(PyObject *elements, double gm_m3_s2, const char *where, pl_orbit *out) {
  pl_elements el;
  const struct {
    const char *key;
    double *value;
  } members[] = {
      {"periapsis_m", &el.periapsis_m},
      {"eccentricity", &el.eccentricity},
      {"inclination_rad", &el.inclination_rad},
      {"raan_rad", &el.raan_rad},
      {"arg_periapsis_rad", &el.arg_periapsis_rad},
      {"since_periapsis_s", &el.since_periapsis_s},
  };
  for (size_t i = 0; i < sizeof members / sizeof members[0]; i++)
    if (pl_py_member_double(elements, members[i].key, where, members[i].value) < 0)
      return -1;
  const pl_status status = pl_orbit_from_elements(&el, gm_m3_s2, out);
  return status == PL_OK ? 0 : fail_at(where, status);
}

/* Index of mapping[key] in the `count` texts of `allowed`, or -1. */
static int read_choice(PyObject *mapping, const char *key, const char *where,
                       const char *const *allowed, int count) {
  PyObject *owner = NULL;
  const char *text = NULL;
  if (pl_py_member_text(mapping, key, where, &owner, &text) < 0)
    return -1;
  int found = -1;
  for (int i = 0; i < count; i++)
    if (strcmp(text, allowed[i]) == 0)
      found = i;
  if (found < 0) {
    char names[96] = "";
    for (int i = 0, used = 0; i < count && used < (int)sizeof names; i++)
      used +=
          snprintf(names + used, sizeof names - (size_t)used, "%s%s", i ? ", " : "", allowed[i]);
    PyErr_Format(PyExc_ValueError, "%s: %s is '%s'; allowed: %s", where, key, text, names);
  }
  Py_DECREF(owner);
  return found;
}

/* mapping[key] as a body; None or a missing key gives NULL where `optional`. */
static int read_body(PyObject *mapping, const char *key, int optional, const char *where,
                     const pl_body **out) {
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
      const pl_status status = pl_body_require(name, out);
      result = status == PL_OK ? 0 : fail_at(where, status);
    }
  }
  Py_DECREF(item);
  return result;
}

static int read_kepler(PyObject *motion, const char *where, pl_motion *out) {
  static const char *const frames[] = {"icrf", "equator"};
  double gm = 0.0;
  const pl_body *body = NULL;
  const int frame = read_choice(motion, "frame", where, frames, 2);
  if (frame < 0 || pl_py_member_double(motion, "gm", where, &gm) < 0 ||
      read_body(motion, "parent_body", 1, where, &body) < 0)
    return -1;
  if (frame == 1 && !body) {
    PyErr_Format(PyExc_ValueError, "%s: the frame 'equator' needs parent_body", where);
    return -1;
  }
  out->equator = frame == 1 ? body : NULL;
  PyObject *elements = NULL;
  if (pl_py_member(motion, "elements", 0, where, &elements) < 0)
    return -1;
  const int result = pl_py_read_orbit(elements, gm, where, &out->orbit);
  Py_DECREF(elements);
  return result;
}

static int read_motion(PyObject *motion, const char *where, pl_motion *out) {
  static const char *const kinds[] = {"fixed", "kepler"};
  const int kind = read_choice(motion, "kind", where, kinds, 2);
  if (kind < 0)
    return -1;
  out->kind = kind == 0 ? PL_MOTION_FIXED : PL_MOTION_KEPLER;
  if (out->kind == PL_MOTION_KEPLER)
    return read_kepler(motion, where, out);
  return pl_py_member_doubles(motion, "position_m", where, 3, &out->position_m.x);
}

static int read_turn(PyObject *rotation, const char *where, pl_turn *out) {
  static const char *const kinds[] = {"fixed", "spin", "body", "lvlh"};
  static const pl_turn_kind turns[] = {PL_TURN_FIXED, PL_TURN_SPIN, PL_TURN_BODY, PL_TURN_LVLH};
  const int kind = read_choice(rotation, "kind", where, kinds, 4);
  if (kind < 0)
    return -1;
  out->kind = turns[kind];
  if (out->kind == PL_TURN_LVLH)
    return 0;
  if (out->kind == PL_TURN_BODY)
    return read_body(rotation, "body", 0, where, &out->body);
  if (pl_py_member_doubles(rotation, "q", where, 4, &out->q.w) < 0)
    return -1;
  if (out->kind == PL_TURN_FIXED)
    return 0;
  if (pl_py_member_doubles(rotation, "axis", where, 3, &out->axis.x) < 0)
    return -1;
  return pl_py_member_double(rotation, "rate_rad_s", where, &out->rate_rad_s);
}

/* One node. *owner keeps its name alive. */
static int read_node(PyObject *item, Py_ssize_t index, pl_node *out, PyObject **owner) {
  char where[WHERE_SIZE];
  snprintf(where, sizeof where, "nodes[%zd]", index);
  PyObject *part = NULL;
  if (pl_py_member_text(item, "name", where, owner, &out->name) < 0 ||
      pl_py_member(item, "parent", 0, where, &part) < 0)
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
  int result = read_motion(part, where, &out->motion);
  Py_DECREF(part);
  if (result < 0)
    return -1;
  snprintf(where, sizeof where, "node '%.100s': rotation", out->name);
  if (pl_py_member(item, "rotation", 0, where, &part) < 0)
    return -1;
  result = read_turn(part, where, &out->turn);
  Py_DECREF(part);
  return result;
}

/* A tree from a sequence of mappings. `names`, a list, keeps the names alive; NULL on failure. */
static pl_tree *read_tree(PyObject *sequence, PyObject *names, Py_ssize_t count) {
  pl_node *nodes = pl_alloc((size_t)count, sizeof *nodes);
  if (!nodes) {
    PyErr_NoMemory();
    return NULL;
  }
  int result = 0;
  for (Py_ssize_t i = 0; i < count && result == 0; i++) {
    PyObject *item = PySequence_GetItem(sequence, i), *owner = NULL;
    result = item ? read_node(item, i, &nodes[i], &owner) : -1;
    if (result == 0)
      result = PyList_Append(names, owner);
    Py_XDECREF(owner);
    Py_XDECREF(item);
  }
  pl_tree *tree = NULL;
  if (result == 0) {
    const pl_status status = pl_tree_create((size_t)count, nodes, &tree);
    if (status != PL_OK)
      pl_py_raise(status);
  }
  pl_free(nodes);
  return tree;
}

static PyObject *poses_of(const pl_tree *tree, Py_ssize_t count, double day, double fraction,
                          PyArrayObject *times) {
  npy_intp shape[3] = {PyArray_SIZE(times), count, 7};
  PyObject *out = PyArray_SimpleNew(3, shape, NPY_DOUBLE);
  if (!out)
    return NULL;
  const double *t_s = PyArray_DATA(times);
  pl_pose *poses = PyArray_DATA((PyArrayObject *)out);
  pl_status status;
  Py_BEGIN_ALLOW_THREADS status = pl_tree_poses(tree, day, fraction, (size_t)shape[0], t_s, poses);
  Py_END_ALLOW_THREADS if (status == PL_OK) return out;
  Py_DECREF(out);
  return pl_py_raise(status);
}

PyObject *pl_py_tree_poses(PyObject *module, PyObject *args, PyObject *kwargs) {
  static char *keywords[] = {"nodes", "tdb_day", "tdb_fraction", "t_s", NULL};
  (void)module;
  PyObject *nodes = NULL, *time_object = NULL;
  double day = 0.0, fraction = 0.0;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OddO:tree_poses", keywords, &nodes, &day,
                                   &fraction, &time_object))
    return NULL;
  const Py_ssize_t count = PySequence_Size(nodes);
  PyObject *names = count < 0 ? NULL : PyList_New(0);
  if (!names)
    return NULL;
  pl_tree *tree = read_tree(nodes, names, count);
  PyArrayObject *times = tree ? pl_py_doubles(time_object, "t_s") : NULL;
  PyObject *out = times ? poses_of(tree, count, day, fraction, times) : NULL;
  Py_XDECREF((PyObject *)times);
  pl_tree_destroy(tree);
  Py_DECREF(names);
  return out;
}
