/* Camera optics for Python: the table of lens models, parsing of requests, and projection for
 * labels. */
#include "pyext/py_camera.h"

#include "pyext/py_types.h"

static const pl_lens_model *model_by_name(PyObject *name) {
  for (size_t i = 0; PyUnicode_Check(name) && i < pl_lens_model_count; i++)
    if (PyUnicode_CompareWithASCIIString(name, pl_lens_models[i].name) == 0)
      return &pl_lens_models[i];
  PyErr_SetString(PyExc_ValueError, "lens: no such model, see LENSES");
  return NULL;
}

static int parse_lens(PyObject *lens, pl_lens *out) {
  *out = (pl_lens){0};
  if (lens == NULL || lens == Py_None)
    return 0;
  if (!PyTuple_Check(lens) || PyTuple_Size(lens) != 2) {
    PyErr_SetString(PyExc_TypeError, "lens: must be None or (model, coefficients)");
    return -1;
  }
  const pl_lens_model *model = model_by_name(PyTuple_GetItem(lens, 0));
  if (model == NULL)
    return -1;
  const npy_intp shape[1] = {(npy_intp)model->count};
  PyArrayObject *c = pl_py_array(PyTuple_GetItem(lens, 1), "lens", NPY_DOUBLE, 1, shape);
  if (c == NULL)
    return -1;
  const pl_status status = pl_lens_init(model, PyArray_DATA(c), out);
  Py_DECREF((PyObject *)c);
  return status == PL_OK ? 0 : (pl_py_raise(status), -1);
}

static PyObject *names_of(const pl_lens_model *model) {
  PyObject *names = PyTuple_New((Py_ssize_t)model->count);
  for (size_t i = 0; names != NULL && i < model->count; i++) {
    PyObject *name = PyUnicode_FromString(model->coefficients[i]);
    if (name == NULL)
      Py_CLEAR(names);
    else
      PyTuple_SetItem(names, (Py_ssize_t)i, name);
  }
  return names;
}

PyObject *pl_py_lenses(void) {
  PyObject *rows = PyDict_New();
  for (size_t i = 0; rows != NULL && i < pl_lens_model_count; i++) {
    const pl_lens_model *model = &pl_lens_models[i];
    PyObject *row = Py_BuildValue("{s:s,s:N}", "doc", model->doc, "coefficients", names_of(model));
    if (row == NULL || PyDict_SetItemString(rows, model->name, row) < 0)
      Py_CLEAR(rows);
    Py_XDECREF(row);
  }
  return rows;
}

int pl_py_camera_focus(PyObject *focus, pl_camera *out) {
  double distance_m;
  out->aperture_m = out->focus_per_m = 0.0;
  if (focus == NULL || focus == Py_None)
    return PyErr_Occurred() ? -1 : 0;
  if (!PyTuple_Check(focus)) {
    PyErr_SetString(PyExc_TypeError, "focus: must be None or (aperture_m, distance_m)");
    return -1;
  }
  if (!PyArg_ParseTuple(focus, "dd:focus", &out->aperture_m, &distance_m))
    return -1;
  if (!(distance_m > 0.0)) {
    PyErr_SetString(PyExc_ValueError, "focus: the distance must be more than 0 m");
    return -1;
  }
  out->focus_per_m = 1.0 / distance_m;
  return 0;
}

int pl_py_camera_optics(PyObject *k_object, PyObject *lens, pl_camera *out) {
  const npy_intp shape[2] = {3, 3};
  PyArrayObject *k = pl_py_array(k_object, "K", NPY_DOUBLE, 2, shape);
  if (k == NULL)
    return -1;
  const double *m = PyArray_DATA(k);
  out->fx = m[0];
  out->skew = m[1];
  out->cx = m[2];
  out->fy = m[4];
  out->cy = m[5];
  Py_DECREF((PyObject *)k);
  return parse_lens(lens, &out->lens);
}

/* What a camera says of a row of numbers; NaN where it says nothing. */
typedef void row_fn(const pl_camera *camera, const double *in, double *out);

/* Of each row (N, wide) of the third argument `what`: (N, tall). `format`: of the arguments. */
static PyObject *of_rows(PyObject *args, const char *format, const char *what, npy_intp wide,
                         npy_intp tall, row_fn *say) {
  PyObject *k, *lens, *given;
  pl_camera camera = {0};
  if (!PyArg_ParseTuple(args, format, &k, &lens, &given) ||
      pl_py_camera_optics(k, lens, &camera) < 0)
    return NULL;
  const npy_intp any[2] = {-1, wide};
  PyArrayObject *rows = pl_py_array(given, what, NPY_DOUBLE, 2, any);
  if (rows == NULL)
    return NULL;
  const npy_intp shape[2] = {PyArray_DIM(rows, 0), tall};
  PyObject *result = PyArray_SimpleNew(2, shape, NPY_DOUBLE);
  const double *in = PyArray_DATA(rows);
  double *out = result != NULL ? PyArray_DATA((PyArrayObject *)result) : NULL;
  for (npy_intp i = 0; result != NULL && i < shape[0]; i++, in += wide, out += tall)
    say(&camera, in, out);
  Py_DECREF((PyObject *)rows);
  return result;
}

static void project(const pl_camera *camera, const double *in, double *out) {
  if (!pl_camera_project(camera, (pl_vec3){in[0], in[1], in[2]}, out))
    out[0] = out[1] = NAN;
}

static void unproject(const pl_camera *camera, const double *in, double *out) {
  const pl_vec3 ray = pl_camera_ray(camera, in[0], in[1]);
  const double length = pl_vec3_norm(ray);
  out[0] = length > 0.0 ? ray.x / length : NAN;
  out[1] = length > 0.0 ? ray.y / length : NAN;
  out[2] = length > 0.0 ? ray.z / length : NAN;
}

PyObject *pl_py_project(PyObject *module, PyObject *args) {
  (void)module;
  return of_rows(args, "OOO:project", "points", 3, 2, project);
}

PyObject *pl_py_unproject(PyObject *module, PyObject *args) {
  (void)module;
  return of_rows(args, "OOO:unproject", "pixels", 2, 3, unproject);
}
