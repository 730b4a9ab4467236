/* The type RockField: rocks of a body as a function of place. */
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "pyext/py_read.h"
#include "pyext/py_sizes.h"
#include "pyext/py_types.h"
#include "terrain/rock_field.h"
#include "terrain/rock_surface.h"

typedef struct rocks_object {
  PyObject_HEAD pl_rock_field *field; /* owned */
  PyObject *scans;                    /* owned: the RockScans that the field borrows from */
} rocks_object;

static void rocks_dealloc(PyObject *self) {
  PyTypeObject *type = Py_TYPE(self);
  pl_rock_field_destroy(((rocks_object *)self)->field);
  Py_XDECREF(((rocks_object *)self)->scans);
  ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
  Py_DECREF(type);
}

const pl_rock_field *pl_py_rocks_of(PyObject *object) {
  if (!pl_py_is(object, (void *)rocks_dealloc)) {
    PyErr_SetString(PyExc_TypeError, "rocks must be a perilune._core.RockField");
    return NULL;
  }
  return ((rocks_object *)object)->field;
}

/* ---- creation ------------------------------------------------------------------------------- */

static int law_of(PyObject *settings, pl_rock_law_kind *out) {
  const char *names[PL_ROCK_LAWS];
  int kind = (int)*out;
  for (int k = 0; k < PL_ROCK_LAWS; k++)
    names[k] = pl_rock_laws[k].name;
  if (pl_py_optional_choice(settings, "law", "rocks", names, PL_ROCK_LAWS, &kind) < 0)
    return -1;
  *out = (pl_rock_law_kind)kind;
  return 0;
}

static pl_rock_family_kind find_family(const char *name) {
  int k = 0;
  while (k < PL_ROCK_FAMILIES && strcmp(name, pl_rock_families[k].name) != 0)
    k++;
  return (pl_rock_family_kind)k;
}

/* Weights of families by name; those that are not named have none. */
static int families_of(PyObject *settings, double weights[PL_ROCK_FAMILIES]) {
  PyObject *given, *name, *weight;
  if (pl_py_member(settings, "families", 1, "rocks", &given) < 0)
    return -1;
  if (given == Py_None) {
    Py_DECREF(given);
    return 0;
  }
  Py_ssize_t at = 0;
  int failed = !PyDict_Check(given);
  if (failed)
    PyErr_SetString(PyExc_TypeError, "rocks: families must be a dict of names and weights");
  memset(weights, 0, PL_ROCK_FAMILIES * sizeof *weights);
  while (!failed && PyDict_Next(given, &at, &name, &weight)) {
    const char *text = PyUnicode_Check(name) ? PyUnicode_AsUTF8AndSize(name, NULL) : "";
    const pl_rock_family_kind kind = text != NULL ? find_family(text) : PL_ROCK_FAMILIES;
    if (kind < PL_ROCK_FAMILIES)
      weights[kind] = PyFloat_AsDouble(weight);
    else if (text != NULL)
      PyErr_Format(PyExc_ValueError, "rocks: no family '%s'; see ROCK_FAMILIES", text);
    failed = PyErr_Occurred() != NULL;
  }
  Py_DECREF(given);
  return failed ? -1 : 0;
}

/* Returns the tuple of the models' scans (a new reference), or NULL with an exception. */
static PyObject *scans_of(PyObject *settings, const pl_rock_scan *list[PL_ROCK_VARIANTS],
                          pl_rock_frame *frame) {
  PyObject *given;
  if (pl_py_member(settings, "models", 1, "rocks", &given) < 0)
    return NULL;
  PyObject *scans = given == Py_None ? PyTuple_New(0) : PySequence_Tuple(given);
  Py_DECREF(given);
  const Py_ssize_t count = scans != NULL ? PyTuple_Size(scans) : 0;
  for (Py_ssize_t k = 0; k < count && k < PL_ROCK_VARIANTS; k++) {
    list[k] = pl_py_rock_scan_of(PyTuple_GetItem(scans, k));
    if (list[k] == NULL) {
      Py_DECREF(scans);
      return NULL;
    }
  }
  frame->scans = list;
  frame->scan_count = (size_t)count;
  return scans;
}

static int frame_of(PyObject *settings, pl_rock_frame *frame, double **table) {
  double radius_m;
  if (pl_py_member_double(settings, "radius_m", "rocks", &radius_m) < 0)
    return -1;
  *frame = pl_rock_frame_default(radius_m);
  const struct {
    const char *key;
    double *to;
  } numbers[] = {{"density", &frame->law.factor},
                 {"abundance", &frame->law.abundance},
                 {"decay_per_m", &frame->law.decay_per_m},
                 {"coefficient", &frame->law.coefficient},
                 {"exponent", &frame->law.exponent},
                 {"cutoff_m", &frame->law.cutoff_m},
                 {"min_diameter_m", &frame->min_m},
                 {"max_diameter_m", &frame->max_m},
                 {"least_burial", &frame->least_burial},
                 {"most_burial", &frame->most_burial},
                 {"repose_rad", &frame->repose_rad},
                 {"fillet", &frame->fillet},
                 {"ejecta_at_rim", &frame->ejecta.at_rim},
                 {"ejecta_life_ga", &frame->ejecta.craters.life_ga},
                 {"ejecta_least_crater_m", &frame->ejecta.craters.least_m}};
  for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++)
    if (pl_py_optional_double(settings, numbers[k].key, "rocks", numbers[k].to) < 0)
      return -1;
  if (pl_py_optional_seed(settings, "seed", "rocks", &frame->seed) < 0 ||
      law_of(settings, &frame->law.kind) < 0 || families_of(settings, frame->families) < 0)
    return -1;
  return pl_py_size_points_of(settings, "rocks", &frame->law.table, table);
}

static PyObject *rocks_new(PyTypeObject *type, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"settings", NULL};
  PyObject *settings;
  pl_rock_frame frame;
  const pl_rock_scan *list[PL_ROCK_VARIANTS];
  double *table = NULL;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O:RockField", names, &settings))
    return NULL;
  rocks_object *self = NULL;
  PyObject *scans =
      frame_of(settings, &frame, &table) == 0 ? scans_of(settings, list, &frame) : NULL;
  if (scans != NULL)
    self = (rocks_object *)((allocfunc)PyType_GetSlot(type, Py_tp_alloc))(type, 0);
  if (self != NULL)
    self->scans = scans;
  else
    Py_XDECREF(scans);
  const pl_status status = self != NULL ? pl_rock_field_create(&frame, &self->field) : PL_OK;
  pl_free(table);
  if (status == PL_OK)
    return (PyObject *)self;
  Py_DECREF((PyObject *)self);
  return pl_py_raise(status);
}

/* ---- lists ---------------------------------------------------------------------------------- */

PyObject *pl_py_rock_record(void) {
  /* The struct has no padding, so the compiler's layout equals NumPy's packed layout. */
  _Static_assert(sizeof(pl_rock) == 2 * 8 + 22 * 8, "pl_rock has padding");
  return Py_BuildValue("[(ss),(ss),(ss),(ss),(ss),(ss),(ss(i)),(ss(i)),(ss(i)),(ss(ii))]", "id",
                       "<u8", "family", "<i8", "diameter_m", "<f8", "height_m", "<f8", "burial",
                       "<f8", "slope_rad", "<f8", "direction", "<f8", 3, "center", "<f8", 3, "up",
                       "<f8", 3, "rotation", "<f8", 3, 3);
}

static PyObject *list(PyObject *self, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"terrain",        "direction",      "radius_m",
                          "min_diameter_m", "max_diameter_m", NULL};
  const npy_intp shape[1] = {3};
  PyObject *ground, *object;
  double radius_m, min_m = 0.0, max_m = 1e300;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OOd|dd:list", names, &ground, &object, &radius_m,
                                   &min_m, &max_m))
    return NULL;
  const pl_terrain *terrain = pl_py_terrain_of(ground);
  PyArrayObject *array =
      terrain != NULL ? pl_py_array(object, "direction", NPY_DOUBLE, 1, shape) : NULL;
  if (array == NULL)
    return NULL;
  const pl_vec3 direction = *(const pl_vec3 *)PyArray_DATA(array);
  Py_DECREF((PyObject *)array);
  const pl_rock_field *field = ((rocks_object *)self)->field;
  pl_rock *rocks;
  size_t count;
  pl_status status;
  Py_BEGIN_ALLOW_THREADS status =
      pl_rock_list(field, terrain, direction, radius_m, min_m, max_m, &rocks, &count);
  Py_END_ALLOW_THREADS if (status != PL_OK) return pl_py_raise(status);
  PyObject *out = pl_py_records(pl_py_rock_record(), rocks, count, sizeof *rocks);
  pl_free(rocks);
  return out;
}

static pl_status find_all(const pl_rock_field *field, const pl_terrain *terrain,
                          const uint64_t *ids, size_t count, pl_rock *out) {
  pl_rock_shape shape;
  for (size_t k = 0; k < count; k++)
    if (!pl_rock_find(field, terrain, ids[k], &out[k], &shape))
      return pl_fail(PL_E_RANGE, "no rock with the id %llu", (unsigned long long)ids[k]);
  return PL_OK;
}

PyObject *pl_py_rocks_find(const pl_terrain *terrain, PyObject *object) {
  const npy_intp shape[1] = {-1};
  const pl_rock_field *field = pl_terrain_rocks(terrain);
  if (field == NULL)
    return PyErr_Format(PyExc_ValueError, "the terrain has no rocks");
  PyArrayObject *ids = pl_py_array(object, "ids", NPY_UINT64, 1, shape);
  if (ids == NULL)
    return NULL;
  const size_t count = (size_t)PyArray_DIM(ids, 0);
  void *rocks = NULL;
  pl_status status = pl_alloc_or_fail(count, sizeof(pl_rock), "rocks", &rocks);
  if (status == PL_OK)
    status = find_all(field, terrain, PyArray_DATA(ids), count, rocks);
  PyObject *out = status == PL_OK
                      ? pl_py_records(pl_py_rock_record(), rocks, count, sizeof(pl_rock))
                      : pl_py_raise(status);
  pl_free(rocks);
  Py_DECREF((PyObject *)ids);
  return out;
}

/* (rocks, points, first) of surfaces, which it frees. */
static PyObject *surfaces_out(pl_rock_surfaces *found) {
  const npy_intp points[2] = {(npy_intp)found->first[found->count], 3};
  const npy_intp firsts[1] = {(npy_intp)found->count + 1};
  PyObject *rocks = pl_py_records(pl_py_rock_record(), found->rocks, found->count, sizeof(pl_rock));
  PyObject *at = PyArray_SimpleNew(2, points, NPY_DOUBLE);
  PyObject *first = PyArray_SimpleNew(1, firsts, NPY_INT64);
  PyObject *out = NULL;
  if (rocks != NULL && at != NULL && first != NULL) {
    if (points[0] > 0)
      memcpy(PyArray_DATA((PyArrayObject *)at), found->points, (size_t)points[0] * sizeof(pl_vec3));
    int64_t *places = PyArray_DATA((PyArrayObject *)first);
    for (size_t k = 0; k <= found->count; k++)
      places[k] = (int64_t)found->first[k];
    out = PyTuple_Pack(3, rocks, at, first);
  }
  Py_XDECREF(rocks);
  Py_XDECREF(at);
  Py_XDECREF(first);
  pl_rock_surfaces_clear(found);
  return out;
}

PyObject *pl_py_rock_surfaces(const pl_terrain *terrain, PyObject *args) {
  const npy_intp any[1] = {-1}, three[1] = {3};
  PyObject *given, *place;
  double pixel_rad;
  const pl_rock_field *field = pl_terrain_rocks(terrain);
  if (!PyArg_ParseTuple(args, "OOd:rock_surfaces", &given, &place, &pixel_rad))
    return NULL;
  if (field == NULL)
    return PyErr_Format(PyExc_ValueError, "the terrain has no rocks");
  if (!(pixel_rad > 0.0 && isfinite(pixel_rad)))
    return PyErr_Format(PyExc_ValueError, "pixel_rad: must be finite and above 0");
  PyArrayObject *eye = pl_py_array(place, "eye", NPY_DOUBLE, 1, three);
  PyArrayObject *ids = eye != NULL ? pl_py_array(given, "ids", NPY_UINT64, 1, any) : NULL;
  PyObject *out = NULL;
  if (ids != NULL) {
    pl_rock_surfaces found;
    pl_status status;
    Py_BEGIN_ALLOW_THREADS status =
        pl_rock_surfaces_find(field, terrain, PyArray_DATA(ids), (size_t)PyArray_DIM(ids, 0),
                              *(const pl_vec3 *)PyArray_DATA(eye), pixel_rad, &found);
    Py_END_ALLOW_THREADS out = status == PL_OK ? surfaces_out(&found) : pl_py_raise(status);
  }
  Py_XDECREF((PyObject *)ids);
  Py_XDECREF((PyObject *)eye);
  return out;
}

static PyMethodDef rocks_methods[] = {
    {"list", (PyCFunction)(void (*)(void))list, METH_VARARGS | METH_KEYWORDS,
     "list($self, terrain, direction, radius_m, min_diameter_m=0.0, max_diameter_m=1e300)\n--\n\n"
     "Rocks of a region."},
    {NULL, NULL, 0, NULL},
};

static PyType_Slot rocks_slots[] = {
    {Py_tp_doc, "RockField(settings)\n--\n\nRocks of a body as a function of place."},
    {Py_tp_new, (void *)rocks_new},
    {Py_tp_dealloc, (void *)rocks_dealloc},
    {Py_tp_methods, rocks_methods},
    {0, NULL},
};

PyType_Spec pl_py_rocks_spec = {"perilune._core.RockField", sizeof(rocks_object), 0,
                                Py_TPFLAGS_DEFAULT, rocks_slots};
