/* The type Rings: flat rings around a body, and their radiance and transmittance. */
#include "pyext/py_types.h"

#include "rings/rings.h"

typedef struct rings_object {
  PyObject_HEAD pl_rings *rings; /* owned */
} rings_object;

static void rings_dealloc(PyObject *self) {
  PyTypeObject *type = Py_TYPE(self);
  pl_rings_destroy(((rings_object *)self)->rings);
  ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
  Py_DECREF(type);
}

const pl_rings *pl_py_rings_of(PyObject *object) {
  if (!pl_py_is(object, (void *)rings_dealloc)) {
    PyErr_SetString(PyExc_TypeError, "rings must be a perilune._core.Rings");
    return NULL;
  }
  return ((rings_object *)object)->rings;
}

/* Radii, depths and albedos as arrays (owned references, NULL after a failure). */
typedef struct profile {
  PyArrayObject *edges, *depth, *albedo;
} profile;

static void profile_drop(profile *p) {
  Py_XDECREF((PyObject *)p->edges);
  Py_XDECREF((PyObject *)p->depth);
  Py_XDECREF((PyObject *)p->albedo);
}

static int profile_take(PyObject *const in[3], profile *out, pl_rings_settings *settings) {
  npy_intp shape[2] = {-1, 3};
  *out = (profile){0};
  out->depth = pl_py_array(in[1], "depth", NPY_DOUBLE, 1, shape);
  if (out->depth == NULL)
    return -1;
  shape[0] = PyArray_DIM(out->depth, 0);
  out->albedo = pl_py_array(in[2], "albedo", NPY_DOUBLE, 2, shape);
  shape[0] += 1;
  out->edges = out->albedo != NULL ? pl_py_array(in[0], "edges_m", NPY_DOUBLE, 1, shape) : NULL;
  if (out->edges == NULL)
    return -1;
  settings->count = (size_t)PyArray_DIM(out->depth, 0);
  settings->edges_m = PyArray_DATA(out->edges);
  settings->depth = PyArray_DATA(out->depth);
  settings->albedo = PyArray_DATA(out->albedo);
  return 0;
}

static PyObject *rings_new(PyTypeObject *type, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"edges_m", "depth", "albedo", "exponent", "dust_share", "dust_g", NULL};
  PyObject *in[3];
  pl_rings_settings settings = {0};
  profile profile;
  rings_object *self = NULL;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OOOddd:Rings", names, &in[0], &in[1], &in[2],
                                   &settings.exponent, &settings.dust_share, &settings.dust_g))
    return NULL;
  if (profile_take(in, &profile, &settings) == 0)
    self = (rings_object *)((allocfunc)PyType_GetSlot(type, Py_tp_alloc))(type, 0);
  if (self != NULL) {
    pl_status status;
    Py_BEGIN_ALLOW_THREADS status = pl_rings_create(&settings, &self->rings);
    Py_END_ALLOW_THREADS if (status != PL_OK) {
      Py_DECREF((PyObject *)self);
      self = NULL;
      pl_py_raise(status);
    }
  }
  profile_drop(&profile);
  return (PyObject *)self;
}

/* Writes the result for one cone to a row of (scattered, passed). */
static void look(const pl_rings *rings, const pl_rings_ray *ray, const pl_rings_sun *sun,
                 double *scattered, double *passed) {
  const pl_rings_light light = pl_rings_seen(rings, ray, sun);
  for (int k = 0; k < 3; k++)
    scattered[k] = light.scattered[k];
  *passed = light.transmittance;
}

static PyObject *rings_scatter(PyObject *self, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"points",  "directions", "sun", "sun_radius_rad",
                          "width_m", "spread",     NULL};
  const pl_rings *rings = ((rings_object *)self)->rings;
  PyObject *points, *directions, *out = NULL;
  pl_rings_ray ray = {.end_m = INFINITY};
  pl_rings_sun sun;
  double sun_radius_rad;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OO(ddd)ddd:scatter", names, &points, &directions,
                                   &sun.direction.x, &sun.direction.y, &sun.direction.z,
                                   &sun_radius_rad, &ray.width_m, &ray.spread))
    return NULL;
  sun.sin_radius = sin(sun_radius_rad);
  npy_intp shape[2] = {-1, 3};
  PyArrayObject *from = pl_py_array(points, "points", NPY_DOUBLE, 2, shape), *to = NULL;
  if (from != NULL) {
    shape[0] = PyArray_DIM(from, 0);
    to = pl_py_array(directions, "directions", NPY_DOUBLE, 2, shape);
  }
  PyObject *light = to != NULL ? PyArray_SimpleNew(2, shape, NPY_DOUBLE) : NULL;
  PyObject *passed = to != NULL ? PyArray_SimpleNew(1, shape, NPY_DOUBLE) : NULL;
  if (light != NULL && passed != NULL) {
    const double *o = PyArray_DATA(from), *d = PyArray_DATA(to);
    for (npy_intp i = 0; i < shape[0]; i++) {
      ray.origin = (pl_vec3){o[3 * i], o[3 * i + 1], o[3 * i + 2]};
      ray.direction = (pl_vec3){d[3 * i], d[3 * i + 1], d[3 * i + 2]};
      look(rings, &ray, &sun, (double *)PyArray_DATA((PyArrayObject *)light) + 3 * i,
           (double *)PyArray_DATA((PyArrayObject *)passed) + i);
    }
    out = PyTuple_Pack(2, light, passed);
  }
  Py_XDECREF((PyObject *)from);
  Py_XDECREF((PyObject *)to);
  Py_XDECREF(light);
  Py_XDECREF(passed);
  return out;
}

static PyMethodDef rings_methods[] = {
    {"scatter", (PyCFunction)(void (*)(void))rings_scatter, METH_VARARGS | METH_KEYWORDS,
     "Sunlight scattered towards points, and what passes."},
    {NULL, NULL, 0, NULL},
};

static PyType_Slot rings_slots[] = {
    {Py_tp_doc, "Rings(edges_m, depth, albedo, exponent, dust_share, dust_g)\n--\n\nFlat rings."},
    {Py_tp_new, (void *)rings_new},
    {Py_tp_dealloc, (void *)rings_dealloc},
    {Py_tp_methods, rings_methods},
    {0, NULL},
};

PyType_Spec pl_py_rings_spec = {"perilune._core.Rings", sizeof(rings_object), 0, Py_TPFLAGS_DEFAULT,
                                rings_slots};
