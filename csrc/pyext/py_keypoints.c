/* "keypoints" of the request dictionary, and the description of their labels. */
#include "base/memory.h"
#include "pyext/py_read.h"
#include "pyext/py_request.h"
#include "pyext/py_types.h"

static const char where[] = "keypoints";

/* Numbers of a keypoint: owner, moving node, place (3), depth. */
enum { ROW = 6 };

static bool is_index(double value) { return value >= 0.0 && value < 1e9; }

static int take(PyArrayObject *rows, pl_py_states *states, pl_frame_request *out) {
  const size_t count = (size_t)PyArray_DIM(rows, 0);
  const double *row = PyArray_DATA(rows);
  if (count > states->keypoint_room) {
    pl_keypoint *grown = pl_realloc(states->keypoints, count, sizeof *grown);
    if (grown == NULL)
      return PyErr_NoMemory(), -1;
    states->keypoints = grown;
    states->keypoint_room = count;
  }
  for (size_t i = 0; i < count; i++, row += ROW) {
    if (!is_index(row[0]) || !is_index(row[1])) {
      PyErr_Format(PyExc_ValueError, "keypoints: row %zu has a bad owner or node", i);
      return -1;
    }
    states->keypoints[i] = (pl_keypoint){.owner = (size_t)row[0],
                                         .mover = (int32_t)row[1],
                                         .place = {row[2], row[3], row[4]},
                                         .deep_m = row[5]};
  }
  out->keypoints = states->keypoints;
  out->keypoint_count = count;
  return 0;
}

int pl_py_keypoints_parse(PyObject *request, pl_py_states *states, pl_frame_request *out) {
  const npy_intp shape[2] = {-1, ROW};
  PyObject *given;
  if (pl_py_member(request, where, 1, "request", &given) < 0)
    return -1;
  if (given == Py_None) {
    Py_DECREF(given);
    return 0;
  }
  PyArrayObject *rows = pl_py_array(given, where, NPY_DOUBLE, 2, shape);
  Py_DECREF(given);
  const int failed = rows == NULL || take(rows, states, out) < 0;
  Py_XDECREF((PyObject *)rows);
  return failed ? -1 : 0;
}

PyObject *pl_py_keypoint_label(void) {
  /* The struct has no padding, so the compiler's layout equals NumPy's packed layout. */
  _Static_assert(sizeof(pl_keypoint_label) == 5 * 8 + 2 * 4, "pl_keypoint_label has padding");
  return Py_BuildValue("[(ss(i)),(ss(i)),(ss),(ss)]", "xy", "<f8", 2, "position_m", "<f8", 3,
                       "visible", "<i4", "occluded_by", "<i4");
}
