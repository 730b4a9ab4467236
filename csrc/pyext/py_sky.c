/* The type Stars, the sky of a request, and the visible stars of a result. */
#include "pyext/py_sky.h"

#include <string.h>

#include "base/memory.h"
#include "pyext/py_read.h"
#include "pyext/py_types.h"

static const char WHERE[] = "sky";

typedef struct stars_object {
  PyObject_HEAD pl_star_catalogue *catalogue; /* owned */
} stars_object;

static void stars_dealloc(PyObject *self) {
  PyTypeObject *type = Py_TYPE(self);
  pl_star_catalogue_destroy(((stars_object *)self)->catalogue);
  ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
  Py_DECREF(type);
}

/* Columns of a catalogue: directions, light per band, magnitudes, catalogue numbers. */
enum { DIRECTIONS, LIGHT, MAGNITUDES, NUMBERS, COLUMNS };

static pl_status build(PyArrayObject *const *columns, size_t count, pl_star_catalogue **out) {
  const double *direction = PyArray_DATA(columns[DIRECTIONS]);
  const double *light = PyArray_DATA(columns[LIGHT]);
  const double *magnitude = PyArray_DATA(columns[MAGNITUDES]);
  const int64_t *number = PyArray_DATA(columns[NUMBERS]);
  void *memory;
  PL_TRY(pl_alloc_or_fail(count, sizeof(pl_star), "stars", &memory));
  pl_star *stars = memory;
  for (size_t i = 0; i < count; i++)
    stars[i] =
        (pl_star){.direction = {direction[3 * i], direction[3 * i + 1], direction[3 * i + 2]},
                  .light = {(float)light[3 * i], (float)light[3 * i + 1], (float)light[3 * i + 2]},
                  .magnitude = (float)magnitude[i],
                  .number = number[i]};
  const pl_status status = pl_star_catalogue_create(stars, count, out);
  pl_free(stars);
  return status;
}

static int read_columns(PyObject *const *given, PyArrayObject **columns) {
  static const char *const names[COLUMNS] = {"directions", "light", "magnitudes", "numbers"};
  npy_intp shape[2] = {-1, 3};
  for (int i = 0; i < COLUMNS; i++) {
    const int type = i == NUMBERS ? NPY_INT64 : NPY_DOUBLE;
    columns[i] = pl_py_array(given[i], names[i], type, i <= LIGHT ? 2 : 1, shape);
    if (columns[i] == NULL)
      return -1;
    shape[0] = PyArray_DIM(columns[i], 0);
  }
  return 0;
}

static PyObject *stars_new(PyTypeObject *type, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"directions", "light", "magnitudes", "numbers", NULL};
  PyObject *given[COLUMNS];
  PyArrayObject *columns[COLUMNS] = {NULL};
  stars_object *self = NULL;
  pl_status status = PL_OK;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OOOO:Stars", names, &given[0], &given[1],
                                   &given[2], &given[3]))
    return NULL;
  if (read_columns(given, columns) == 0)
    self = (stars_object *)((allocfunc)PyType_GetSlot(type, Py_tp_alloc))(type, 0);
  if (self != NULL)
    status = build(columns, (size_t)PyArray_DIM(columns[0], 0), &self->catalogue);
  for (int i = 0; i < COLUMNS; i++)
    Py_XDECREF((PyObject *)columns[i]);
  if (self != NULL && status != PL_OK) {
    Py_DECREF(self);
    return pl_py_raise(status);
  }
  return (PyObject *)self;
}

static PyObject *get_count(PyObject *self, void *closure) {
  (void)closure;
  return PyLong_FromSize_t(((stars_object *)self)->catalogue->count);
}

static PyGetSetDef stars_getset[] = {
    {"count", get_count, NULL, "Number of stars.", NULL},
    {NULL, NULL, NULL, NULL, NULL},
};

static PyType_Slot stars_slots[] = {
    {Py_tp_doc, "Stars(directions, light, magnitudes, numbers)\n--\n\nA catalogue of stars."},
    {Py_tp_new, (void *)stars_new},
    {Py_tp_dealloc, (void *)stars_dealloc},
    {Py_tp_getset, stars_getset},
    {0, NULL},
};

PyType_Spec pl_py_stars_spec = {"perilune._core.Stars", sizeof(stars_object), 0, Py_TPFLAGS_DEFAULT,
                                stars_slots};

/* --- requests */

static int parse_stars(PyObject *given, PyObject *kept, pl_sky *out) {
  PyObject *stars;
  if (pl_py_member(given, "stars", 1, WHERE, &stars) < 0)
    return -1;
  const int fits = stars == Py_None || pl_py_is(stars, (void *)stars_dealloc);
  if (!fits)
    PyErr_SetString(PyExc_TypeError, "sky: stars must be a perilune._core.Stars or None");
  else if (stars != Py_None)
    out->stars = ((stars_object *)stars)->catalogue;
  const int failed = !fits || PyList_Append(kept, stars) < 0;
  Py_DECREF(stars);
  return failed ? -1 : 0;
}

static int parse_axes(PyObject *given, pl_mat3 *out) {
  const npy_intp shape[2] = {3, 3};
  PyArrayObject *axes = pl_py_member_array(given, "axes", WHERE, 2, shape);
  if (axes == NULL)
    return -1;
  const double *m = PyArray_DATA(axes);
  for (int i = 0; i < 3; i++)
    out->row[i] = (pl_vec3){m[3 * i], m[3 * i + 1], m[3 * i + 2]};
  Py_DECREF((PyObject *)axes);
  return 0;
}

static int parse_backdrop(PyObject *given, PyObject *kept, pl_sky *out) {
  static const char *const kinds[PL_BACKDROP_KINDS] = {"none", "map", "cover", "stretch"};
  PyObject *map;
  double white[3];
  int by_display;
  const int kind = pl_py_member_choice(given, "kind", WHERE, kinds, PL_BACKDROP_KINDS);
  if (kind < 0 || pl_py_member_doubles(given, "white", WHERE, 3, white) < 0 ||
      pl_py_member_bool(given, "by_display", WHERE, &by_display) < 0 ||
      parse_axes(given, &out->backdrop.from_root) < 0 ||
      pl_py_member(given, "map", 0, WHERE, &map) < 0)
    return -1;
  out->backdrop.texture = pl_py_map_of(map);
  const int failed = out->backdrop.texture == NULL || PyList_Append(kept, map) < 0;
  Py_DECREF(map);
  out->backdrop.kind = (pl_backdrop_kind)kind;
  out->by_display = by_display != 0;
  for (int band = 0; band < 3; band++)
    out->backdrop.white[band] = (float)white[band];
  return failed ? -1 : 0;
}

static int parse(PyObject *given, PyObject *kept, pl_sky *out) {
  PyObject *backdrop;
  double beta[3];
  *out = (pl_sky){0};
  if (parse_stars(given, kept, out) < 0 ||
      pl_py_member_doubles(given, "beta", WHERE, 3, beta) < 0 ||
      pl_py_member(given, "backdrop", 1, WHERE, &backdrop) < 0)
    return -1;
  out->beta = (pl_vec3){beta[0], beta[1], beta[2]};
  const int failed = backdrop != Py_None ? parse_backdrop(backdrop, kept, out) : 0;
  Py_DECREF(backdrop);
  return failed;
}

int pl_py_sky_parse(PyObject *request, pl_py_states *states, pl_frame_request *out) {
  PyObject *given;
  if (pl_py_member(request, "sky", 1, "request", &given) < 0)
    return -1;
  const int failed = given != Py_None ? parse(given, states->kept, &states->sky) : 0;
  out->sky = given != Py_None ? &states->sky : NULL;
  Py_DECREF(given);
  return failed;
}

/* --- results */

PyObject *pl_py_seen_stars(const pl_frame_result *result) {
  const npy_intp shape[2] = {(npy_intp)result->star_count, 2};
  PyObject *numbers = PyArray_SimpleNew(1, shape, NPY_INT64);
  PyObject *pixels = PyArray_SimpleNew(2, shape, NPY_DOUBLE);
  PyObject *magnitudes = PyArray_SimpleNew(1, shape, NPY_FLOAT);
  if (numbers == NULL || pixels == NULL || magnitudes == NULL) {
    Py_XDECREF(numbers);
    Py_XDECREF(pixels);
    Py_XDECREF(magnitudes);
    return NULL;
  }
  for (size_t i = 0; i < result->star_count; i++) {
    const pl_seen_star *seen = &result->stars[i];
    ((int64_t *)PyArray_DATA((PyArrayObject *)numbers))[i] = seen->star->number;
    ((double *)PyArray_DATA((PyArrayObject *)pixels))[2 * i] = seen->u;
    ((double *)PyArray_DATA((PyArrayObject *)pixels))[2 * i + 1] = seen->v;
    ((float *)PyArray_DATA((PyArrayObject *)magnitudes))[i] = seen->star->magnitude;
  }
  return Py_BuildValue("{s:N,s:N,s:N}", "number", numbers, "pixel", pixels, "magnitude",
                       magnitudes);
}
