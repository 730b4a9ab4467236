/* The type Raster: georeferenced numbers on a body. */
#include "pyext/py_types.h"

#include <math.h>
#include <string.h>

#include "terrain/raster.h"

typedef struct raster_object {
  PyObject_HEAD pl_raster *raster; /* owned */
  PyObject *kept;                  /* list that holds the samples, and their memory in place */
} raster_object;

static void raster_dealloc(PyObject *self) {
  PyTypeObject *type = Py_TYPE(self);
  pl_raster_destroy(((raster_object *)self)->raster);
  Py_XDECREF(((raster_object *)self)->kept);
  ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
  Py_DECREF(type);
}

const pl_raster *pl_py_raster_of(PyObject *object) {
  if (!pl_py_is(object, (void *)raster_dealloc)) {
    PyErr_SetString(PyExc_TypeError, "raster must be a perilune._core.Raster");
    return NULL;
  }
  return ((raster_object *)object)->raster;
}

static int type_of(PyArrayObject *array, pl_raster_type *out) {
  switch (PyArray_TYPE(array)) {
  case NPY_UINT8:
    *out = PL_RASTER_UINT8;
    return 0;
  case NPY_INT16:
    *out = PL_RASTER_INT16;
    return 0;
  case NPY_UINT16:
    *out = PL_RASTER_UINT16;
    return 0;
  case NPY_FLOAT:
    *out = PL_RASTER_FLOAT32;
    return 0;
  default:
    PyErr_SetString(PyExc_ValueError, "samples must be of uint8, int16, uint16 or float32");
    return -1;
  }
}

/* Borrows the samples without a copy: they may be a memory map of gigabytes. */
static int lend(PyObject *samples, PyObject *kept, pl_raster_frame *out) {
  if (!PyArray_Check(samples)) {
    PyErr_SetString(PyExc_TypeError, "samples must be an array");
    return -1;
  }
  PyArrayObject *array = (PyArrayObject *)samples;
  if (pl_py_keep_memory(kept, samples) < 0 || type_of(array, &out->type) < 0)
    return -1;
  if (PyArray_NDIM(array) != 2) {
    PyErr_Format(PyExc_ValueError, "samples must have 2 dimensions, not %d", PyArray_NDIM(array));
    return -1;
  }
  const npy_intp size = PyArray_ITEMSIZE(array), *shape = PyArray_DIMS(array);
  const npy_intp row = PyArray_STRIDE(array, 0);
  const int dense = PyArray_SIZE(array) == 0 || shape[1] < 2 || PyArray_STRIDE(array, 1) == size;
  if (!PyArray_ISALIGNED(array) || !PyArray_ISNOTSWAPPED(array) || !dense ||
      (shape[0] > 1 && shape[1] > 0 && (row < shape[1] * size || row % size != 0))) {
    PyErr_SetString(PyExc_ValueError, "samples must be aligned, in native byte order, and rows of "
                                      "adjacent numbers from first to last");
    return -1;
  }
  out->samples = PyArray_DATA(array);
  out->width = (size_t)shape[1];
  out->height = (size_t)shape[0];
  out->stride = shape[0] > 1 ? (size_t)(row / size) : 0;
  return 0;
}

static int parse(PyObject *args, PyObject *kwargs, PyObject **samples, pl_raster_frame *f) {
  static char *names[] = {"samples",  "projection", "x0",         "y0",       "dx",
                          "dy",       "scale",      "offset",     "lon0_rad", "lat0_rad",
                          "radius_m", "map_scale",  "axis_ratio", NULL};
  const char *projection;
  pl_projection *p = &f->projection;
  f->scale = p->scale = p->axis_ratio = 1.0;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "Osdddd|ddddddd:Raster", names, samples,
                                   &projection, &f->x0, &f->y0, &f->dx, &f->dy, &f->scale,
                                   &f->offset, &p->lon0_rad, &p->lat0_rad, &p->radius_m, &p->scale,
                                   &p->axis_ratio))
    return -1;
  const pl_status status = pl_projection_find(projection, &p->kind);
  if (status == PL_OK)
    return 0;
  pl_py_raise(status);
  return -1;
}

static PyObject *raster_new(PyTypeObject *type, PyObject *args, PyObject *kwargs) {
  PyObject *samples;
  pl_raster_frame frame = {0};
  if (parse(args, kwargs, &samples, &frame) < 0)
    return NULL;
  raster_object *self = (raster_object *)((allocfunc)PyType_GetSlot(type, Py_tp_alloc))(type, 0);
  if (self == NULL)
    return NULL;
  self->kept = PyList_New(0);
  if (self->kept == NULL || lend(samples, self->kept, &frame) < 0) {
    Py_DECREF(self);
    return NULL;
  }
  pl_status status;
  Py_BEGIN_ALLOW_THREADS status = pl_raster_create(&frame, &self->raster);
  Py_END_ALLOW_THREADS if (status != PL_OK) {
    Py_DECREF(self);
    return pl_py_raise(status);
  }
  return (PyObject *)self;
}

static int interpolation_of(const char *name, pl_raster_interpolation *out) {
  static const char *const names[PL_INTERPOLATION_COUNT] = {"bilinear", "cubic"};
  for (int k = 0; k < PL_INTERPOLATION_COUNT; k++)
    if (strcmp(name, names[k]) == 0) {
      *out = (pl_raster_interpolation)k;
      return 0;
    }
  PyErr_SetString(PyExc_ValueError, "an interpolation is 'bilinear' or 'cubic'");
  return -1;
}

/* An array of (n, columns) numbers and a new one of (n, wide), or of (n,) if wide is 1. */
typedef struct work {
  PyArrayObject *in, *out;
  const double *from;
  double *to;
  npy_intp count;
} work;

static int prepare(PyObject *given, const char *what, npy_intp columns, npy_intp wide, work *w) {
  const npy_intp shape[2] = {-1, columns};
  w->in = pl_py_array(given, what, NPY_DOUBLE, 2, shape);
  if (w->in == NULL)
    return -1;
  w->count = PyArray_DIM(w->in, 0);
  npy_intp size[2] = {w->count, wide};
  w->out = (PyArrayObject *)PyArray_SimpleNew(wide > 1 ? 2 : 1, size, NPY_DOUBLE);
  if (w->out == NULL) {
    Py_DECREF((PyObject *)w->in);
    return -1;
  }
  w->from = PyArray_DATA(w->in);
  w->to = PyArray_DATA(w->out);
  return 0;
}

static PyObject *finished(work *w) {
  Py_DECREF((PyObject *)w->in);
  return (PyObject *)w->out;
}

static pl_vec3 vector(const double *p) { return (pl_vec3){p[0], p[1], p[2]}; }

/* Column and row, NAN for a direction that is not finite. */
static bool find(const pl_raster *raster, const double *direction, double *u, double *v) {
  const pl_vec3 d = vector(direction);
  return pl_vec3_finite(d) && pl_vec3_dot(d, d) > 0.0 && pl_raster_find(raster, d, u, v);
}

static PyObject *raster_values(PyObject *self, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"directions", "interpolation", "level", NULL};
  const pl_raster *raster = ((raster_object *)self)->raster;
  PyObject *directions;
  const char *name = "bilinear";
  int level = 0;
  pl_raster_interpolation how;
  work w;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O|si:values", names, &directions, &name,
                                   &level) ||
      interpolation_of(name, &how) < 0 || prepare(directions, "directions", 3, 1, &w) < 0)
    return NULL;
  Py_BEGIN_ALLOW_THREADS for (npy_intp i = 0; i < w.count; i++) {
    double u, v;
    w.to[i] =
        find(raster, w.from + 3 * i, &u, &v) ? pl_raster_value(raster, level, u, v, how) : NAN;
  }
  Py_END_ALLOW_THREADS return finished(&w);
}

static PyObject *raster_weights(PyObject *self, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"directions", "border_posts", NULL};
  const pl_raster *raster = ((raster_object *)self)->raster;
  PyObject *directions;
  double border;
  work w;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "Od:weights", names, &directions, &border) ||
      prepare(directions, "directions", 3, 1, &w) < 0)
    return NULL;
  for (npy_intp i = 0; i < w.count; i++) {
    double u, v;
    w.to[i] = find(raster, w.from + 3 * i, &u, &v) ? pl_raster_weight(raster, u, v, border) : 0.0;
  }
  return finished(&w);
}

static PyObject *raster_posts(PyObject *self, PyObject *directions) {
  const pl_raster *raster = ((raster_object *)self)->raster;
  work w;
  if (prepare(directions, "directions", 3, 2, &w) < 0)
    return NULL;
  for (npy_intp i = 0; i < w.count; i++)
    if (!find(raster, w.from + 3 * i, &w.to[2 * i], &w.to[2 * i + 1]))
      w.to[2 * i] = w.to[2 * i + 1] = NAN;
  return finished(&w);
}

static PyObject *raster_directions(PyObject *self, PyObject *posts) {
  const pl_raster *raster = ((raster_object *)self)->raster;
  work w;
  if (prepare(posts, "posts", 2, 3, &w) < 0)
    return NULL;
  for (npy_intp i = 0; i < w.count; i++) {
    const pl_vec3 d = pl_raster_direction(raster, w.from[2 * i], w.from[2 * i + 1]);
    w.to[3 * i] = d.x;
    w.to[3 * i + 1] = d.y;
    w.to[3 * i + 2] = d.z;
  }
  return finished(&w);
}

static PyObject *raster_spacing_m(PyObject *self, PyObject *radius) {
  const double radius_m = PyFloat_AsDouble(radius);
  if (PyErr_Occurred())
    return NULL;
  return PyFloat_FromDouble(pl_raster_spacing_m(((raster_object *)self)->raster, radius_m));
}

static PyObject *raster_bounds(PyObject *self, PyObject *args) {
  const char *name = "bilinear";
  pl_raster_interpolation how;
  double low, high;
  if (!PyArg_ParseTuple(args, "|s:bounds", &name) || interpolation_of(name, &how) < 0)
    return NULL;
  pl_raster_bounds(((raster_object *)self)->raster, how, &low, &high);
  return Py_BuildValue("(dd)", low, high);
}

static PyObject *get_levels(PyObject *self, void *closure) {
  (void)closure;
  return PyLong_FromLong(pl_raster_levels(((raster_object *)self)->raster));
}

static PyObject *get_whole(PyObject *self, void *closure) {
  (void)closure;
  return PyBool_FromLong(pl_raster_whole(((raster_object *)self)->raster));
}

static PyMethodDef raster_methods[] = {
    {"values", (PyCFunction)(void (*)(void))raster_values, METH_VARARGS | METH_KEYWORDS,
     "values($self, directions, interpolation='bilinear', level=0)\n--\n\n(n,) values."},
    {"weights", (PyCFunction)(void (*)(void))raster_weights, METH_VARARGS | METH_KEYWORDS,
     "weights($self, directions, border_posts)\n--\n\n(n,) weights of blending."},
    {"posts", raster_posts, METH_O,
     "posts($self, directions, /)\n--\n\n(n, 2) columns and rows of directions."},
    {"directions", raster_directions, METH_O,
     "directions($self, posts, /)\n--\n\n(n, 3) unit directions of columns and rows."},
    {"spacing_m", raster_spacing_m, METH_O,
     "spacing_m($self, radius_m, /)\n--\n\nDistance of posts."},
    {"bounds", raster_bounds, METH_VARARGS,
     "bounds($self, interpolation='bilinear', /)\n--\n\nLeast and greatest value."},
    {NULL, NULL, 0, NULL},
};

static PyGetSetDef raster_getset[] = {
    {"levels", get_levels, NULL, "Number of levels of its pyramid.", NULL},
    {"whole", get_whole, NULL, "Whether it covers the whole body.", NULL},
    {NULL, NULL, NULL, NULL, NULL},
};

static PyType_Slot raster_slots[] = {
    {Py_tp_doc, "Raster(samples, projection, x0, y0, dx, dy, scale=1.0, offset=0.0, lon0_rad=0.0, "
                "lat0_rad=0.0, radius_m=0.0, map_scale=1.0, axis_ratio=1.0)\n--\n\n"
                "Georeferenced numbers on a body."},
    {Py_tp_new, (void *)raster_new},
    {Py_tp_dealloc, (void *)raster_dealloc},
    {Py_tp_methods, raster_methods},
    {Py_tp_getset, raster_getset},
    {0, NULL},
};

PyType_Spec pl_py_raster_spec = {"perilune._core.Raster", sizeof(raster_object), 0,
                                 Py_TPFLAGS_DEFAULT, raster_slots};
