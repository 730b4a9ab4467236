/* "motion" of the request dictionary: timing of the exposure of rows, and motion keys of everything
 * that moves during the exposure. */
#include "pyext/py_request.h"

#include <string.h>

#include "base/memory.h"
#include "pyext/py_read.h"
#include "pyext/py_types.h"

/* Poses are copied directly from the arrays: x y z qw qx qy qz. */
_Static_assert(sizeof(pl_pose) == 7 * sizeof(double), "a pose is seven doubles");
_Static_assert(sizeof(pl_vec3) == 3 * sizeof(double), "a vector is three doubles");

typedef struct reader {
  PyObject *motion;
  int keys;           /* number of the camera's keys; 0 for none */
  pl_py_keys *buffer; /* memory for all keys */
  size_t used;        /* doubles in use */
} reader;

static double *take(reader *reader, size_t count) {
  double *at = reader->buffer->numbers + reader->used;
  reader->used += count;
  return at;
}

static int grow(pl_py_keys *keys, size_t count) {
  if (count <= keys->room)
    return 0;
  double *grown = pl_realloc(keys->numbers, count, sizeof *grown);
  if (grown == NULL)
    return PyErr_NoMemory(), -1;
  keys->numbers = grown;
  keys->room = count;
  return 0;
}

/* Copies an array of the key's shape to memory that stays valid until the next request. */
static double *read_array(reader *reader, const char *key, int nd, const npy_intp *shape) {
  PyObject *value = Py_XNewRef(PyDict_GetItemString(reader->motion, key));
  if (value == NULL) {
    PyErr_Format(PyExc_KeyError, "motion lacks '%s'", key);
    return NULL;
  }
  PyArrayObject *array = pl_py_array(value, key, NPY_DOUBLE, nd, shape);
  Py_DECREF(value);
  if (array == NULL)
    return NULL;
  size_t count = 1;
  for (int i = 0; i < nd; i++)
    count *= (size_t)shape[i];
  double *at = take(reader, count);
  memcpy(at, PyArray_DATA(array), count * sizeof *at);
  Py_DECREF((PyObject *)array);
  return at;
}

static void set_keys(pl_motion *motion, const double *poses, int keys) {
  motion->keys = (const pl_pose *)(const void *)poses;
  motion->key_count = keys;
  motion->open = motion->keys[0];
  motion->close = motion->keys[keys - 1];
}

static int read_poses(reader *reader, const pl_scene *scene, pl_py_states *states,
                      pl_placement *placement) {
  const npy_intp k = reader->keys, objects = (npy_intp)scene->craft_count;
  const npy_intp bodies = (npy_intp)scene->body_count;
  const double *camera = read_array(reader, "camera", 2, (npy_intp[]){k, 7});
  const double *object =
      camera != NULL ? read_array(reader, "objects", 3, (npy_intp[]){objects, k, 7}) : NULL;
  const double *body =
      object != NULL ? read_array(reader, "bodies", 3, (npy_intp[]){bodies, k, 7}) : NULL;
  const double *sun = body != NULL ? read_array(reader, "sun", 2, (npy_intp[]){k, 3}) : NULL;
  if (sun == NULL)
    return -1;
  set_keys(&placement->camera.motion, camera, reader->keys);
  for (npy_intp i = 0; i < objects; i++)
    set_keys(&states->objects[i].motion, object + 7 * k * i, reader->keys);
  for (npy_intp i = 0; i < bodies; i++)
    set_keys(&states->bodies[i].motion, body + 7 * k * i, reader->keys);
  placement->sun.keys = (const pl_vec3 *)(const void *)sun;
  placement->sun.key_count = reader->keys;
  return 0;
}

/* Reads (keys, nodes, 3, 4) as affine motions, grouped by object. */
static int read_movers(reader *reader, const pl_scene *scene, pl_py_states *states) {
  const npy_intp nodes = (npy_intp)states->mover_count;
  if (nodes == 0)
    return 0;
  const npy_intp shape[4] = {reader->keys, nodes, 3, 4};
  const double *m = read_array(reader, "movers", 4, shape);
  if (m == NULL)
    return -1;
  pl_affine *next = (pl_affine *)(void *)take(reader, 12 * (size_t)(reader->keys * nodes));
  size_t first = 0;
  for (size_t i = 0; i < scene->craft_count; i++) {
    const size_t own = pl_object_mover_count(&scene->objects[i]);
    states->objects[i].mover_keys = own > 0 ? next : NULL;
    states->objects[i].mover_key_count = reader->keys;
    for (size_t key = 0; key < (size_t)reader->keys; key++)
      for (size_t k = 0; k < own; k++) {
        const double *a = m + 12 * (key * (size_t)nodes + first + k);
        *next++ = (pl_affine){{{{a[0], a[1], a[2]}, {a[4], a[5], a[6]}, {a[8], a[9], a[10]}}},
                              {a[3], a[7], a[11]}};
      }
    first += own;
  }
  return 0;
}

/* Counts the keys of the camera; all others must have as many. */
static int count_keys(PyObject *motion, int *keys) {
  PyObject *camera;
  *keys = 0;
  if (pl_py_member(motion, "camera", 1, "motion", &camera) < 0)
    return -1;
  const bool given = camera != Py_None;
  const Py_ssize_t count = given ? PySequence_Size(camera) : 0;
  Py_DECREF(camera);
  if (!given || count < 0)
    return given ? -1 : 0;
  if (count < 3 || count % 2 == 0 || count > 4097) {
    PyErr_Format(PyExc_ValueError, "motion: the camera has %zd keys; allowed: odd, 3..4097", count);
    return -1;
  }
  *keys = (int)count;
  return 0;
}

static int read_times(PyObject *motion, pl_shutter *shutter) {
  PyObject *times = Py_XNewRef(PyDict_GetItemString(motion, "times"));
  int is_held = 0, read = 0;
  if (times != NULL && PyTuple_Check(times))
    read = PyArg_ParseTuple(times, "ddp:times", &shutter->exposure_s, &shutter->line_s, &is_held);
  else
    PyErr_SetString(PyExc_TypeError, "motion.times: must be (exposure_s, line_s, held)");
  Py_XDECREF(times);
  shutter->held = is_held != 0;
  return read ? 0 : -1;
}

static int parse(PyObject *motion, const pl_scene *scene, pl_py_states *states,
                 pl_placement *placement) {
  reader reader = {.motion = motion, .buffer = &states->keys};
  if (!PyDict_Check(motion)) {
    PyErr_SetString(PyExc_TypeError, "motion: must be None or a dict");
    return -1;
  }
  if (read_times(motion, &placement->shutter) < 0 || count_keys(motion, &reader.keys) < 0)
    return -1;
  if (reader.keys == 0)
    return 0;
  const size_t entities = 1 + scene->craft_count + scene->body_count;
  if (grow(&states->keys, (size_t)reader.keys * (7 * entities + 3 + 24 * states->mover_count)) <
          0 ||
      read_poses(&reader, scene, states, placement) < 0)
    return -1;
  return read_movers(&reader, scene, states);
}

int pl_py_motion_parse(PyObject *request, const pl_scene *scene, pl_py_states *states,
                       pl_placement *placement) {
  PyObject *motion;
  placement->shutter = (pl_shutter){0};
  if (pl_py_member(request, "motion", 1, "request", &motion) < 0)
    return -1;
  const int failed = motion != Py_None ? parse(motion, scene, states, placement) : 0;
  Py_DECREF(motion);
  return failed;
}
