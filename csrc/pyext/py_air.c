/* The type Air: an atmosphere and its radiative transfer around a spherical body. */
#include "pyext/py_types.h"

#include <string.h>

#include "pyext/py_read.h"

typedef struct air_object {
  PyObject_HEAD pl_air *air; /* owned */
} air_object;

static void air_dealloc(PyObject *self) {
  PyTypeObject *type = Py_TYPE(self);
  pl_air_destroy(((air_object *)self)->air);
  ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
  Py_DECREF(type);
}

const pl_air *pl_py_air_of(PyObject *object) {
  if (!pl_py_is(object, (void *)air_dealloc)) {
    PyErr_SetString(PyExc_TypeError, "air must be a perilune._core.Air");
    return NULL;
  }
  return ((air_object *)object)->air;
}

static int parse_settings(PyObject *from, pl_air_settings *out) {
  const char *where = "Air";
  int multiple = 0;
  double rayleigh_upper[2], mie_upper[2];
  const struct {
    const char *key;
    double *value;
    npy_intp count;
  } members[] = {
      {"rayleigh_scattering", out->rayleigh_scattering, 3},
      {"rayleigh_height_m", &out->rayleigh_height_m, 1},
      {"rayleigh_upper_m", rayleigh_upper, 2},
      {"mie_scattering", out->mie_scattering, 3},
      {"mie_extinction", out->mie_extinction, 3},
      {"mie_height_m", &out->mie_height_m, 1},
      {"mie_upper_m", mie_upper, 2},
      {"mie_g", out->mie_g, 3},
      {"ozone_absorption", out->ozone_absorption, 3},
      {"ozone_center_m", &out->ozone_center_m, 1},
      {"ozone_width_m", &out->ozone_width_m, 1},
      {"top_m", &out->top_m, 1},
      {"ground_albedo", out->ground_albedo, 3},
  };
  for (size_t i = 0; i < sizeof members / sizeof members[0]; i++)
    if (members[i].count == 1
            ? pl_py_member_double(from, members[i].key, where, members[i].value) < 0
            : pl_py_member_doubles(from, members[i].key, where, members[i].count,
                                   members[i].value) < 0)
      return -1;
  if (pl_py_member_bool(from, "multiple", where, &multiple) < 0)
    return -1;
  out->multiple = multiple != 0;
  out->rayleigh_upper_from_m = rayleigh_upper[0];
  out->rayleigh_upper_height_m = rayleigh_upper[1];
  out->mie_upper_from_m = mie_upper[0];
  out->mie_upper_height_m = mie_upper[1];
  return 0;
}

static PyObject *air_new(PyTypeObject *type, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"settings", "radius_m", NULL};
  PyObject *from;
  pl_air_settings settings;
  double radius_m;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "Od:Air", names, &from, &radius_m) ||
      parse_settings(from, &settings) < 0)
    return NULL;
  air_object *self = (air_object *)((allocfunc)PyType_GetSlot(type, Py_tp_alloc))(type, 0);
  if (self == NULL)
    return NULL;
  pl_status status;
  Py_BEGIN_ALLOW_THREADS status = pl_air_create(&settings, radius_m, &self->air);
  Py_END_ALLOW_THREADS if (status != PL_OK) {
    Py_DECREF(self);
    return pl_py_raise(status);
  }
  return (PyObject *)self;
}

/* Points (n, 3), m from the centre of a spherical body, and unit directions (n, 3). */
typedef struct rays {
  PyArrayObject *points, *directions; /* new references, or NULL */
  npy_intp shape[2];
} rays;

static int take_rays(PyObject *points, PyObject *directions, rays *out) {
  const npy_intp any[2] = {-1, 3};
  out->points = pl_py_array(points, "points", NPY_DOUBLE, 2, any);
  out->shape[0] = out->points != NULL ? PyArray_DIM(out->points, 0) : 0;
  out->shape[1] = 3;
  out->directions =
      out->points != NULL ? pl_py_array(directions, "directions", NPY_DOUBLE, 2, out->shape) : NULL;
  if (out->directions != NULL)
    return 0;
  Py_CLEAR(out->points);
  return -1;
}

static void drop_rays(rays *r) {
  Py_XDECREF((PyObject *)r->points);
  Py_XDECREF((PyObject *)r->directions);
}

static pl_vec3 row_of(PyArrayObject *array, npy_intp i) {
  const double *v = (const double *)PyArray_DATA(array) + 3 * i;
  return (pl_vec3){v[0], v[1], v[2]};
}

static void put(PyObject *array, npy_intp i, pl_vec3f v) {
  double *out = (double *)PyArray_DATA((PyArrayObject *)array) + 3 * i;
  out[0] = (double)v.x;
  out[1] = (double)v.y;
  out[2] = (double)v.z;
}

static PyObject *air_transmittance(PyObject *self, PyObject *args) {
  PyObject *points, *directions;
  const pl_air *air = ((air_object *)self)->air;
  rays r;
  if (!PyArg_ParseTuple(args, "OO:transmittance", &points, &directions) ||
      take_rays(points, directions, &r) < 0)
    return NULL;
  PyObject *out = PyArray_SimpleNew(2, r.shape, NPY_DOUBLE);
  for (npy_intp i = 0; out != NULL && i < r.shape[0]; i++)
    put(out, i,
        pl_air_transmittance(air, pl_vec3_scale(row_of(r.points, i), 1.0 / pl_air_radius_m(air)),
                             row_of(r.directions, i), 1.0));
  drop_rays(&r);
  return out;
}

static PyObject *air_scatter(PyObject *self, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"points", "directions", "sun",      "sun_radius_rad",
                          "end_m",  "steps",      "multiple", NULL};
  const pl_air *air = ((air_object *)self)->air;
  const double radius_m = pl_air_radius_m(air);
  PyObject *points, *directions, *out = NULL;
  pl_air_sun sun = {.stretch = 1.0};
  double end_m;
  int steps, multiple;
  rays r;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OO(ddd)ddip:scatter", names, &points, &directions,
                                   &sun.direction.x, &sun.direction.y, &sun.direction.z,
                                   &sun.radius_rad, &end_m, &steps, &multiple) ||
      take_rays(points, directions, &r) < 0)
    return NULL;
  const pl_air_rule rule = pl_air_rule_make(steps);
  PyObject *light = PyArray_SimpleNew(2, r.shape, NPY_DOUBLE);
  PyObject *passed = PyArray_SimpleNew(2, r.shape, NPY_DOUBLE);
  for (npy_intp i = 0; light != NULL && passed != NULL && i < r.shape[0]; i++) {
    pl_air_ray ray = {.origin = pl_vec3_scale(row_of(r.points, i), 1.0 / radius_m),
                      .direction = row_of(r.directions, i),
                      .stretch = 1.0,
                      .end = end_m / radius_m};
    ray.sun_cosine = (float)pl_vec3_dot(ray.direction, sun.direction);
    const pl_air_light found = pl_air_scatter(air, &ray, &sun, &rule, multiple != 0);
    put(light, i, found.scattered);
    put(passed, i, found.transmitted);
  }
  if (light != NULL && passed != NULL)
    out = PyTuple_Pack(2, light, passed);
  Py_XDECREF(light);
  Py_XDECREF(passed);
  drop_rays(&r);
  return out;
}

static PyObject *air_skylight(PyObject *self, PyObject *args) {
  double sun_sine;
  int multiple;
  if (!PyArg_ParseTuple(args, "dp:skylight", &sun_sine, &multiple))
    return NULL;
  const pl_vec3f e = pl_air_skylight(((air_object *)self)->air, sun_sine, multiple != 0);
  return Py_BuildValue("(ddd)", (double)e.x, (double)e.y, (double)e.z);
}

static PyMethodDef air_methods[] = {
    {"transmittance", air_transmittance, METH_VARARGS, "Light that comes through to points."},
    {"scatter", (PyCFunction)(void (*)(void))air_scatter, METH_VARARGS | METH_KEYWORDS,
     "Light scattered towards points, and what passes."},
    {"skylight", air_skylight, METH_VARARGS, "Irradiance of the sky on flat ground."},
    {NULL, NULL, 0, NULL},
};

static PyType_Slot air_slots[] = {
    {Py_tp_doc, "Air(settings, radius_m)\n--\n\nAn atmosphere."},
    {Py_tp_new, (void *)air_new},
    {Py_tp_dealloc, (void *)air_dealloc},
    {Py_tp_methods, air_methods},
    {0, NULL},
};

PyType_Spec pl_py_air_spec = {"perilune._core.Air", sizeof(air_object), 0, Py_TPFLAGS_DEFAULT,
                              air_slots};
