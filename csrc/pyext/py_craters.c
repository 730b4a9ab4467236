/* The type CraterField: craters of a body as a function of place. */
#include "base/memory.h"
#include "pyext/py_read.h"
#include "pyext/py_sizes.h"
#include "pyext/py_types.h"
#include "terrain/crater_field.h"

typedef struct craters_object {
  PyObject_HEAD pl_crater_field *field; /* owned */
} craters_object;

static void craters_dealloc(PyObject *self) {
  PyTypeObject *type = Py_TYPE(self);
  pl_crater_field_destroy(((craters_object *)self)->field);
  ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
  Py_DECREF(type);
}

const pl_crater_field *pl_py_craters_of(PyObject *object) {
  if (!pl_py_is(object, (void *)craters_dealloc)) {
    PyErr_SetString(PyExc_TypeError, "craters must be a perilune._core.CraterField");
    return NULL;
  }
  return ((craters_object *)object)->field;
}

/* ---- creation ------------------------------------------------------------------------------- */

static int law_of(PyObject *settings, pl_crater_law_kind *out) {
  const char *names[PL_CRATER_LAWS];
  int kind = (int)*out;
  for (int k = 0; k < PL_CRATER_LAWS; k++)
    names[k] = pl_crater_laws[k].name;
  if (pl_py_optional_choice(settings, "law", "craters", names, PL_CRATER_LAWS, &kind) < 0)
    return -1;
  *out = (pl_crater_law_kind)kind;
  return 0;
}

static int frame_of(PyObject *settings, pl_crater_frame *frame, double **table) {
  double radius_m;
  if (pl_py_member_double(settings, "radius_m", "craters", &radius_m) < 0)
    return -1;
  *frame = pl_crater_frame_default(radius_m);
  const struct {
    const char *key;
    double *to;
  } numbers[] = {{"surface_age_ga", &frame->law.surface_age_ga},
                 {"density", &frame->law.factor},
                 {"coefficient", &frame->law.coefficient},
                 {"exponent", &frame->law.exponent},
                 {"min_diameter_m", &frame->min_m},
                 {"max_diameter_m", &frame->max_m},
                 {"diffusivity_m2_per_myr", &frame->diffusivity_m2_per_myr},
                 {"diffusivity_exponent", &frame->diffusivity_exponent},
                 {"ellipticity", &frame->ellipticity},
                 {"irregularity", &frame->irregularity},
                 {"terraces", &frame->terraces},
                 {"model_posts", &frame->model_posts},
                 {"ray_brightness", &frame->rays.brightness},
                 {"ray_fade_ga", &frame->rays.fade_ga},
                 {"ray_reach", &frame->rays.reach}};
  for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++)
    if (pl_py_optional_double(settings, numbers[k].key, "craters", numbers[k].to) < 0)
      return -1;
  if (pl_py_optional_seed(settings, "seed", "craters", &frame->seed) < 0 ||
      law_of(settings, &frame->law.kind) < 0)
    return -1;
  return pl_py_size_points_of(settings, "craters", &frame->law.table, table);
}

static PyObject *craters_new(PyTypeObject *type, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"settings", NULL};
  PyObject *settings;
  pl_crater_frame frame;
  double *table = NULL;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O:CraterField", names, &settings))
    return NULL;
  craters_object *self = NULL;
  if (frame_of(settings, &frame, &table) == 0)
    self = (craters_object *)((allocfunc)PyType_GetSlot(type, Py_tp_alloc))(type, 0);
  const pl_status status = self != NULL ? pl_crater_field_create(&frame, &self->field) : PL_OK;
  pl_free(table);
  if (status == PL_OK)
    return (PyObject *)self;
  Py_DECREF((PyObject *)self);
  return pl_py_raise(status);
}

/* ---- queries -------------------------------------------------------------------------------- */

static PyObject *heights(PyObject *self, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"directions", "footprint_m", NULL};
  const npy_intp shape[2] = {-1, 3};
  PyObject *object;
  double footprint_m = 0.0;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O|d:heights", names, &object, &footprint_m))
    return NULL;
  if (!(footprint_m >= 0.0))
    return PyErr_Format(PyExc_ValueError, "footprint_m must be at least 0");
  PyArrayObject *array = pl_py_array(object, "directions", NPY_DOUBLE, 2, shape);
  if (array == NULL)
    return NULL;
  npy_intp count = PyArray_DIM(array, 0);
  pl_vec3 *d = PyArray_DATA(array);
  for (npy_intp k = 0; k < count; k++) {
    const double square = pl_vec3_dot(d[k], d[k]);
    if (!(square > 0.0 && isfinite(square))) {
      Py_DECREF((PyObject *)array);
      return PyErr_Format(PyExc_ValueError, "direction %zd is 0 or not finite", (Py_ssize_t)k);
    }
    if (fabs(square - 1.0) > 1e-15)
      d[k] = pl_vec3_unit(d[k]);
  }
  PyObject *out = PyArray_ZEROS(1, &count, NPY_DOUBLE, 0);
  pl_status status = PL_OK;
  if (out != NULL) {
    double *h = PyArray_DATA((PyArrayObject *)out);
    const pl_crater_field *field = ((craters_object *)self)->field;
    Py_BEGIN_ALLOW_THREADS status =
        pl_crater_add_heights(field, NULL, d, (size_t)count, footprint_m, h);
    Py_END_ALLOW_THREADS
  }
  Py_DECREF((PyObject *)array);
  if (status == PL_OK)
    return out;
  Py_DECREF(out);
  return pl_py_raise(status);
}

PyObject *pl_py_crater_record(void) {
  /* The struct has no padding, so the compiler's layout equals NumPy's packed layout. */
  _Static_assert(sizeof(pl_crater) == 8 + 13 * 8, "pl_crater has padding");
  return Py_BuildValue("[(ss),(ss(i)),(ss(i)),(ss),(ss),(ss),(ss),(ss),(ss),(ss)]", "id", "<u8",
                       "direction", "<f8", 3, "major", "<f8", 3, "diameter_m", "<f8", "axis_ratio",
                       "<f8", "age_ga", "<f8", "tau", "<f8", "depth_m", "<f8", "rim_m", "<f8",
                       "kept", "<f8");
}

PyObject *pl_py_crater_list(pl_status status, pl_crater *craters, size_t count) {
  if (status != PL_OK)
    return pl_py_raise(status);
  PyObject *out = pl_py_records(pl_py_crater_record(), craters, count, sizeof *craters);
  pl_free(craters);
  return out;
}

int pl_py_crater_region_of(PyObject *args, PyObject *kwargs, pl_py_crater_region *out) {
  static char *names[] = {"direction", "radius_m", "min_diameter_m", "max_diameter_m", NULL};
  const npy_intp shape[1] = {3};
  PyObject *object;
  *out = (pl_py_crater_region){.max_m = 1e300};
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "Od|dd:craters", names, &object, &out->radius_m,
                                   &out->min_m, &out->max_m))
    return -1;
  PyArrayObject *array = pl_py_array(object, "direction", NPY_DOUBLE, 1, shape);
  if (array == NULL)
    return -1;
  out->direction = *(const pl_vec3 *)PyArray_DATA(array);
  Py_DECREF((PyObject *)array);
  return 0;
}

static PyObject *list(PyObject *self, PyObject *args, PyObject *kwargs) {
  const pl_crater_field *field = ((craters_object *)self)->field;
  pl_py_crater_region at;
  if (pl_py_crater_region_of(args, kwargs, &at) < 0)
    return NULL;
  pl_crater *craters;
  size_t count;
  pl_status status;
  Py_BEGIN_ALLOW_THREADS status =
      pl_crater_list(field, NULL, at.direction, at.radius_m, at.min_m, at.max_m, &craters, &count);
  Py_END_ALLOW_THREADS return pl_py_crater_list(status, craters, count);
}

static PyMethodDef craters_methods[] = {
    {"heights", (PyCFunction)(void (*)(void))heights, METH_VARARGS | METH_KEYWORDS,
     "heights($self, directions, footprint_m=0.0)\n--\n\n(n,) relief of craters, m."},
    {"list", (PyCFunction)(void (*)(void))list, METH_VARARGS | METH_KEYWORDS,
     "list($self, direction, radius_m, min_diameter_m=0.0, max_diameter_m=1e300)\n--\n\n"
     "Craters of a region."},
    {NULL, NULL, 0, NULL},
};

static PyType_Slot craters_slots[] = {
    {Py_tp_doc, "CraterField(settings)\n--\n\nCraters of a body as a function of place."},
    {Py_tp_new, (void *)craters_new},
    {Py_tp_dealloc, (void *)craters_dealloc},
    {Py_tp_methods, craters_methods},
    {0, NULL},
};

PyType_Spec pl_py_craters_spec = {"perilune._core.CraterField", sizeof(craters_object), 0,
                                  Py_TPFLAGS_DEFAULT, craters_slots};
