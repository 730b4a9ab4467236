/* "body_clouds" of the request dictionary: a sequence with None or a mapping for each body. Also
 * evaluates cloud cover. */
#include "pyext/py_request.h"

#include "pyext/py_read.h"
#include "pyext/py_types.h"

static const char WHERE[] = "body_clouds";

static int parse_floats(PyObject *from, pl_clouds *out) {
  const struct {
    const char *key;
    float *value;
  } members[] = {
      {"opacity", &out->opacity},   {"depth", &out->depth},
      {"coverage", &out->coverage}, {"softness", &out->softness},
      {"octaves", &out->octaves},   {"roughness", &out->roughness},
      {"warp", &out->warp},         {"phase", &out->phase},
      {"relief_m", &out->relief_m}, {"depth_spread", &out->depth_spread},
  };
  for (size_t i = 0; i < sizeof members / sizeof members[0]; i++) {
    double value;
    if (pl_py_member_double(from, members[i].key, WHERE, &value) < 0)
      return -1;
    *members[i].value = (float)value;
  }
  return 0;
}

static int parse_clouds(PyObject *from, pl_clouds *out) {
  double color[3];
  size_t seed;
  if (pl_py_member_double(from, "altitude_m", WHERE, &out->altitude_m) < 0 ||
      pl_py_member_double(from, "thickness_m", WHERE, &out->thickness_m) < 0 ||
      pl_py_member_double(from, "turn_rad", WHERE, &out->turn_rad) < 0 ||
      pl_py_member_double(from, "size_m", WHERE, &out->size_m) < 0 ||
      pl_py_member_doubles(from, "color", WHERE, 3, color) < 0 ||
      pl_py_member_size(from, "seed", WHERE, &seed) < 0 || parse_floats(from, out) < 0)
    return -1;
  for (int k = 0; k < 3; k++)
    out->color[k] = (float)color[k];
  out->seed = (uint32_t)seed;
  return 0;
}

static int parse_list(PyObject *list, size_t count, pl_body_state *out) {
  const Py_ssize_t length = PySequence_Size(list);
  if (length < 0)
    return -1;
  if ((size_t)length != count) {
    PyErr_Format(PyExc_ValueError, "%s: %zd entries for %zu bodies", WHERE, length, count);
    return -1;
  }
  for (size_t i = 0; i < count; i++) {
    PyObject *entry = PySequence_GetItem(list, (Py_ssize_t)i);
    const int failed =
        entry == NULL || (entry != Py_None && parse_clouds(entry, &out[i].clouds) < 0);
    Py_XDECREF(entry);
    if (failed)
      return -1;
  }
  return 0;
}

int pl_py_clouds_parse(PyObject *request, size_t count, pl_body_state *out) {
  PyObject *list = Py_XNewRef(PyDict_GetItemString(request, WHERE));
  for (size_t i = 0; i < count; i++)
    out[i].clouds = (pl_clouds){.altitude_m = 0.0};
  if (list == NULL)
    return PyErr_Occurred() ? -1 : 0;
  const int failed = parse_list(list, count, out);
  Py_DECREF(list);
  return failed;
}

static void fill_cover(const pl_clouds *clouds, PyArrayObject *points, double width_m, int detail,
                       double *out) {
  const pl_cloud_cover cover = pl_cloud_cover_make(clouds, NULL, detail);
  /* half side of a square with the area of the disc */
  const double side = 0.5 * sqrt(PL_PI) * width_m;
  for (npy_intp i = 0; i < PyArray_DIM(points, 0); i++) {
    const double *p = (const double *)PyArray_DATA(points) + 3 * i;
    out[i] = (double)pl_cloud_cover_at(&cover, (pl_vec3){p[0], p[1], p[2]}, (pl_vec3){side, 0, 0},
                                       (pl_vec3){0, side, 0});
  }
}

PyObject *pl_py_cloud_cover(PyObject *module, PyObject *args) {
  const npy_intp shape[2] = {-1, 3};
  PyObject *settings, *points;
  pl_clouds clouds = {0};
  double width_m;
  int detail;
  (void)module;
  if (!PyArg_ParseTuple(args, "OOdi:cloud_cover", &settings, &points, &width_m, &detail) ||
      parse_clouds(settings, &clouds) < 0)
    return NULL;
  if (!pl_clouds_valid(&clouds) || !(width_m >= 0.0) || detail < 0) {
    PyErr_SetString(PyExc_ValueError, "clouds, their footprint or their detail out of range");
    return NULL;
  }
  PyArrayObject *array = pl_py_array(points, "points", NPY_DOUBLE, 2, shape);
  if (array == NULL)
    return NULL;
  const npy_intp count[1] = {PyArray_DIM(array, 0)};
  PyObject *out = PyArray_SimpleNew(1, count, NPY_DOUBLE);
  if (out != NULL)
    fill_cover(&clouds, array, width_m, detail, PyArray_DATA((PyArrayObject *)out));
  Py_DECREF((PyObject *)array);
  return out;
}
