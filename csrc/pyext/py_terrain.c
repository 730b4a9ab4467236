/* The type Terrain: heights of a body's ground. */
#include <string.h>

#include "pyext/py_layers.h"
#include "pyext/py_read.h"
#include "pyext/py_types.h"
#include "terrain/plane_fit.h"

typedef struct terrain_object {
  PyObject_HEAD pl_terrain *terrain; /* owned */
  PyObject *kept;                    /* list of the rasters, craters and rocks */
} terrain_object;

static void terrain_dealloc(PyObject *self) {
  PyTypeObject *type = Py_TYPE(self);
  pl_terrain_destroy(((terrain_object *)self)->terrain);
  Py_XDECREF(((terrain_object *)self)->kept);
  ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
  Py_DECREF(type);
}

const pl_terrain *pl_py_terrain_of(PyObject *object) {
  if (!pl_py_is(object, (void *)terrain_dealloc)) {
    PyErr_SetString(PyExc_TypeError, "terrain must be a perilune._core.Terrain");
    return NULL;
  }
  return ((terrain_object *)object)->terrain;
}

/* ---- creation ------------------------------------------------------------------------------- */

static int interpolation_of(const char *name, pl_raster_interpolation *out) {
  static const char *const names[PL_INTERPOLATION_COUNT] = {"bilinear", "cubic"};
  for (int k = 0; k < PL_INTERPOLATION_COUNT; k++)
    if (strcmp(name, names[k]) == 0) {
      *out = (pl_raster_interpolation)k;
      return 0;
    }
  PyErr_Format(PyExc_ValueError, "interpolation is '%s'; allowed: bilinear, cubic", name);
  return -1;
}

/* Reads (raster, interpolation, border_posts, datum_m[, apron_m]); the list `kept` gets the raster.
 */
static int layer_of(PyObject *item, PyObject *kept, pl_terrain_layer *out, double *apron_m) {
  PyObject *raster;
  const char *name;
  if (!PyTuple_Check(item)) {
    PyErr_SetString(PyExc_TypeError,
                    "must be (raster, interpolation, border_posts, datum_m[, apron_m])");
    return -1;
  }
  *apron_m = 0.0;
  if (!PyArg_ParseTuple(item, "Osdd|d:layer", &raster, &name, &out->border_posts, &out->datum_m,
                        apron_m) ||
      interpolation_of(name, &out->interpolation) < 0)
    return -1;
  out->raster = pl_py_raster_of(raster);
  return out->raster != NULL ? PyList_Append(kept, raster) : -1;
}

static int layers_of(PyObject *layers, PyObject *kept, pl_terrain_layer out[PL_TERRAIN_LAYERS],
                     double aprons_m[PL_TERRAIN_LAYERS], size_t *count) {
  const Py_ssize_t size = PySequence_Size(layers);
  if (size < 0)
    return -1;
  if (size > PL_TERRAIN_LAYERS) {
    PyErr_Format(PyExc_ValueError, "layers: %zd rasters; at most %d are supported", size,
                 PL_TERRAIN_LAYERS);
    return -1;
  }
  for (Py_ssize_t n = 0; n < size; n++) {
    char where[32];
    PyOS_snprintf(where, sizeof where, "layer %zd", n);
    PyObject *item = PySequence_GetItem(layers, n);
    const int failed = item == NULL || layer_of(item, kept, &out[n], &aprons_m[n]) < 0;
    Py_XDECREF(item);
    if (failed)
      return pl_py_prefix_error(where);
  }
  *count = (size_t)size;
  return 0;
}

static int ranges_of(PyObject *detail, pl_terrain_detail *out) {
  const npy_intp shape[2] = {-1, 2};
  PyObject *given;
  if (pl_py_member(detail, "ranges", 1, "detail", &given) < 0)
    return -1;
  PyArrayObject *array =
      given != Py_None ? pl_py_array(given, "detail: ranges", NPY_DOUBLE, 2, shape) : NULL;
  const int failed = given != Py_None && array == NULL;
  Py_DECREF(given);
  if (array == NULL)
    return failed ? -1 : 0;
  out->range_count = (size_t)PyArray_DIM(array, 0);
  const double *from = PyArray_DATA(array);
  for (size_t k = 0; k < out->range_count && k < PL_DETAIL_RANGES; k++)
    out->ranges[k] = (pl_detail_range){from[2 * k], from[2 * k + 1]};
  Py_DECREF((PyObject *)array);
  return 0;
}

static const char *const METHODS[PL_DETAIL_METHOD_COUNT] = {"noise", "diamond_square"};

/* Keys that are absent keep their defaults. */
static int detail_of(PyObject *detail, double radius_m, pl_terrain_detail *out) {
  *out = pl_terrain_detail_default(radius_m);
  out->on = detail != Py_None;
  if (!out->on)
    return 0;
  int method = (int)out->method;
  if (pl_py_optional_choice(detail, "method", "detail", METHODS, PL_DETAIL_METHOD_COUNT, &method) <
      0)
    return -1;
  out->method = (pl_detail_method)method;
  if (pl_py_optional_seed(detail, "seed", "detail", &out->seed) < 0 || ranges_of(detail, out) < 0)
    return -1;
  const struct {
    const char *key;
    double *to;
  } numbers[] = {{"baseline_m", &out->baseline_m},
                 {"deviation_m", &out->deviation_m},
                 {"strength", &out->strength},
                 {"longest_m", &out->longest_m},
                 {"finest_m", &out->finest_m}};
  for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++)
    if (pl_py_optional_double(detail, numbers[k].key, "detail", numbers[k].to) < 0)
      return -1;
  return 0;
}

static int craters_of(PyObject *craters, PyObject *kept, const pl_crater_field **out) {
  if (craters == Py_None)
    return 0;
  *out = pl_py_craters_of(craters);
  return *out != NULL ? PyList_Append(kept, craters) : -1;
}

static int rocks_of(PyObject *rocks, PyObject *kept, const pl_rock_field **out) {
  if (rocks == Py_None)
    return 0;
  *out = pl_py_rocks_of(rocks);
  return *out != NULL ? PyList_Append(kept, rocks) : -1;
}

/* Reads a sequence of (raster, border_posts); None: no rasters. */
static int stack_of(PyObject *given, const char *what, PyObject *kept, pl_raster_stack *out) {
  pl_raster_sheet sheets[PL_RASTER_STACK];
  const Py_ssize_t size = given != Py_None ? PySequence_Size(given) : 0;
  if (size < 0)
    return -1;
  if (size > PL_RASTER_STACK) {
    PyErr_Format(PyExc_ValueError, "%s: %zd rasters; at most %d are supported", what, size,
                 PL_RASTER_STACK);
    return -1;
  }
  for (Py_ssize_t n = 0; n < size; n++) {
    PyObject *item = PySequence_GetItem(given, n), *raster = NULL;
    const int read = item != NULL && PyTuple_Check(item) &&
                     PyArg_ParseTuple(item, "Od:raster", &raster, &sheets[n].border_posts);
    if (read)
      sheets[n].raster = pl_py_raster_of(raster);
    else if (!PyErr_Occurred())
      PyErr_SetString(PyExc_TypeError, "must be (raster, border_posts)");
    const int failed = !read || sheets[n].raster == NULL || PyList_Append(kept, raster) < 0;
    Py_XDECREF(item);
    if (failed)
      return pl_py_prefix_error(what);
  }
  const pl_status status = pl_raster_stack_init(sheets, (size_t)size, out);
  if (status == PL_OK)
    return 0;
  pl_py_raise(status);
  return pl_py_prefix_error(what);
}

typedef struct parts {
  PyObject *textures;
  PyObject *layers, *detail, *craters, *rocks, *albedo, *roughness, *known, *mask, *patch, *tracks;
  double roughness_baseline_m;
} parts;

/* Reads (n, 4): unit direction and diameter of craters of a catalogue. */
static int known_of(PyObject *given, PyArrayObject **array, pl_terrain_frame *frame) {
  const npy_intp shape[2] = {-1, 4};
  if (given == Py_None)
    return 0;
  *array = pl_py_array(given, "known_craters", NPY_DOUBLE, 2, shape);
  if (*array == NULL)
    return -1;
  _Static_assert(sizeof(pl_known_crater) == 4 * sizeof(double), "a row of the array");
  frame->known = PyArray_DATA(*array);
  frame->known_count = (size_t)PyArray_DIM(*array, 0);
  return 0;
}

/* Reads (direction, side_m); None: no patch. */
static int patch_of(PyObject *given, pl_terrain_patch *out) {
  pl_vec3 *c = &out->center;
  if (given == Py_None)
    return 0;
  if (!PyArg_ParseTuple(given, "(ddd)d:patch", &c->x, &c->y, &c->z, &out->side_m))
    return pl_py_prefix_error("patch");
  return 0;
}

static int create(terrain_object *self, const double radii_m[3], const parts *in) {
  pl_terrain_layer given[PL_TERRAIN_LAYERS];
  double aprons_m[PL_TERRAIN_LAYERS];
  pl_raster_stack albedo, roughness, mask;
  pl_terrain_frame frame = {.radii_m = {radii_m[0], radii_m[1], radii_m[2]},
                            .layers = given,
                            .aprons_m = aprons_m,
                            .albedo = &albedo,
                            .roughness = &roughness,
                            .mask = &mask,
                            .roughness_baseline_m = in->roughness_baseline_m};
  self->kept = PyList_New(0);
  if (self->kept == NULL ||
      (in->layers != NULL &&
       layers_of(in->layers, self->kept, given, aprons_m, &frame.layer_count) < 0) ||
      detail_of(in->detail, radii_m[0], &frame.detail) < 0 ||
      craters_of(in->craters, self->kept, &frame.craters) < 0 ||
      rocks_of(in->rocks, self->kept, &frame.rocks) < 0 ||
      stack_of(in->albedo, "albedo", self->kept, &albedo) < 0 ||
      stack_of(in->roughness, "roughness", self->kept, &roughness) < 0 ||
      stack_of(in->mask, "mask", self->kept, &mask) < 0 || patch_of(in->patch, &frame.patch) < 0)
    return -1;
  PyArrayObject *known = NULL, *arrays[PL_PY_TRACKS] = {NULL};
  pl_wheel_track tracks[PL_PY_TRACKS];
  pl_ground_texture textures[PL_GROUND_TEXTURES];
  frame.tracks = tracks;
  frame.textures = textures;
  int failed = known_of(in->known, &known, &frame) < 0 ||
               pl_py_tracks_of(in->tracks, arrays, tracks, &frame.track_count) < 0 ||
               pl_py_textures_of(in->textures, self->kept, textures, &frame.texture_count) < 0;
  const pl_status status = failed ? PL_OK : pl_terrain_create(&frame, &self->terrain);
  Py_XDECREF((PyObject *)known);
  for (int k = 0; k < PL_PY_TRACKS; k++)
    Py_XDECREF((PyObject *)arrays[k]);
  if (status != PL_OK) {
    pl_py_raise(status);
    failed = 1;
  }
  return failed ? -1 : 0;
}

static PyObject *terrain_new(PyTypeObject *type, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"radii_m",       "layers", "detail",    "craters",
                          "rocks",         "albedo", "roughness", "roughness_baseline_m",
                          "known_craters", "mask",   "patch",     "tracks",
                          "textures",      NULL};
  PyObject *radii;
  parts in = {Py_None, NULL,    Py_None, Py_None, Py_None, Py_None,
              Py_None, Py_None, Py_None, Py_None, Py_None, 0.0};
  const npy_intp shape[1] = {3};
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O|OOOOOOdOOOOO:Terrain", names, &radii,
                                   &in.layers, &in.detail, &in.craters, &in.rocks, &in.albedo,
                                   &in.roughness, &in.roughness_baseline_m, &in.known, &in.mask,
                                   &in.patch, &in.tracks, &in.textures))
    return NULL;
  PyArrayObject *array = pl_py_array(radii, "radii_m", NPY_DOUBLE, 1, shape);
  if (array == NULL)
    return NULL;
  terrain_object *self = (terrain_object *)((allocfunc)PyType_GetSlot(type, Py_tp_alloc))(type, 0);
  const int failed = self == NULL || create(self, PyArray_DATA(array), &in) < 0;
  Py_DECREF((PyObject *)array);
  if (!failed)
    return (PyObject *)self;
  Py_XDECREF((PyObject *)self);
  return NULL;
}

/* ---- heights -------------------------------------------------------------------------------- */

/* Reads directions (n, 3), which are made unit; those that are already keep their bits. */
static PyArrayObject *directions_of(PyObject *object) {
  const npy_intp shape[2] = {-1, 3};
  PyArrayObject *array = pl_py_array(object, "directions", NPY_DOUBLE, 2, shape);
  pl_vec3 *d = array != NULL ? PyArray_DATA(array) : NULL;
  for (npy_intp k = 0; array != NULL && k < PyArray_DIM(array, 0); k++) {
    const double square = pl_vec3_dot(d[k], d[k]);
    if (!(square > 0.0 && isfinite(square))) {
      Py_DECREF((PyObject *)array);
      PyErr_Format(PyExc_ValueError, "direction %zd is 0 or not finite", (Py_ssize_t)k);
      return NULL;
    }
    if (fabs(square - 1.0) > 1e-15)
      d[k] = pl_vec3_unit(d[k]);
  }
  return array;
}

/* Level of cells of at most cell_m; the finest of all for 0. */
static int level_of(const pl_terrain *terrain, double cell_m, int *out) {
  if (!(cell_m >= 0.0)) {
    PyErr_SetString(PyExc_ValueError, "cell_m must be at least 0");
    return -1;
  }
  *out = cell_m > 0.0 ? pl_terrain_level_of(terrain, cell_m) : pl_terrain_finest_level(terrain);
  return 0;
}

/* Returns `array`, or NULL with an exception. */
static PyArrayObject *checked(PyArrayObject *array, pl_status status) {
  if (status == PL_OK)
    return array;
  Py_DECREF((PyObject *)array);
  pl_py_raise(status);
  return NULL;
}

static PyObject *heights(PyObject *self, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"directions", "cell_m", NULL};
  const pl_terrain *terrain = ((terrain_object *)self)->terrain;
  PyObject *object;
  double cell_m = 0.0;
  int level;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O|d:heights", names, &object, &cell_m) ||
      level_of(terrain, cell_m, &level) < 0)
    return NULL;
  PyArrayObject *directions = directions_of(object);
  if (directions == NULL)
    return NULL;
  npy_intp count = PyArray_DIM(directions, 0);
  PyArrayObject *out = (PyArrayObject *)PyArray_SimpleNew(1, &count, NPY_DOUBLE);
  if (out != NULL) {
    const pl_vec3 *d = PyArray_DATA(directions);
    double *h = PyArray_DATA(out);
    pl_status status;
    Py_BEGIN_ALLOW_THREADS status = pl_terrain_heights(terrain, d, (size_t)count, level, h);
    Py_END_ALLOW_THREADS out = checked(out, status);
  }
  Py_DECREF((PyObject *)directions);
  return (PyObject *)out;
}

static PyObject *block(PyObject *self, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"face", "level", "i0", "j0", "width", "height", NULL};
  long long i0, j0;
  pl_terrain_nodes nodes;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "iiLLii:block", names, &nodes.face, &nodes.level,
                                   &i0, &j0, &nodes.width, &nodes.height))
    return NULL;
  if (nodes.face < 0 || nodes.face >= PL_CUBE_FACES || nodes.level < 0 ||
      nodes.level >= PL_CUBE_LEVELS || nodes.width < 1 || nodes.height < 1)
    return PyErr_Format(PyExc_ValueError,
                        "face must be in [0, %d], level in [0, %d], and width "
                        "and height at least 1",
                        PL_CUBE_FACES - 1, PL_CUBE_LEVELS - 1);
  const long long end = (1LL << nodes.level) + 8;
  if (i0 < -8 || j0 < -8 || i0 > end - nodes.width || j0 > end - nodes.height)
    return PyErr_Format(PyExc_ValueError, "nodes must lie at most 8 beyond the edges of the face");
  nodes.i0 = i0;
  nodes.j0 = j0;
  npy_intp shape[2] = {nodes.height, nodes.width};
  PyArrayObject *out = (PyArrayObject *)PyArray_SimpleNew(2, shape, NPY_DOUBLE);
  if (out != NULL) {
    double *h = PyArray_DATA(out);
    pl_status status;
    Py_BEGIN_ALLOW_THREADS status =
        pl_terrain_block(((terrain_object *)self)->terrain, &nodes, h, NULL);
    Py_END_ALLOW_THREADS out = checked(out, status);
  }
  return (PyObject *)out;
}

static PyObject *slopes(PyObject *self, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"directions", "baseline_m", NULL};
  const pl_terrain *terrain = ((terrain_object *)self)->terrain;
  PyObject *object;
  double baseline_m;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "Od:slopes", names, &object, &baseline_m))
    return NULL;
  if (!(baseline_m > 0.0 && isfinite(baseline_m)))
    return PyErr_Format(PyExc_ValueError, "baseline_m must be above 0");
  PyArrayObject *directions = directions_of(object);
  if (directions == NULL)
    return NULL;
  const npy_intp shape[2] = {PyArray_DIM(directions, 0), 3};
  PyArrayObject *out = (PyArrayObject *)PyArray_SimpleNew(2, shape, NPY_DOUBLE);
  if (out != NULL) {
    const pl_vec3 *d = PyArray_DATA(directions);
    pl_vec3 *to = PyArray_DATA(out);
    pl_status status = PL_OK;
    Py_BEGIN_ALLOW_THREADS for (npy_intp k = 0; k < shape[0] && status == PL_OK; k++) status =
        pl_terrain_slope(terrain, d[k], baseline_m, &to[k]);
    Py_END_ALLOW_THREADS out = checked(out, status);
  }
  Py_DECREF((PyObject *)directions);
  return (PyObject *)out;
}

static PyObject *planes(PyObject *self, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"directions", "baseline_m", "points", NULL};
  const pl_terrain *terrain = ((terrain_object *)self)->terrain;
  PyObject *object;
  double baseline_m;
  int points = 32;
  pl_disc disc;
  _Static_assert(sizeof(pl_plane_fit) == 2 * sizeof(double), "pl_plane_fit is no pair");
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "Od|i:planes", names, &object, &baseline_m,
                                   &points))
    return NULL;
  if (!(baseline_m > 0.0 && isfinite(baseline_m)))
    return PyErr_Format(PyExc_ValueError, "baseline_m must be above 0");
  pl_status status = pl_disc_init(points, &disc);
  if (status != PL_OK)
    return pl_py_raise(status);
  PyArrayObject *directions = directions_of(object);
  if (directions == NULL)
    return NULL;
  const npy_intp shape[2] = {PyArray_DIM(directions, 0), 2};
  PyArrayObject *out = (PyArrayObject *)PyArray_SimpleNew(2, shape, NPY_DOUBLE);
  if (out != NULL) {
    const pl_vec3 *d = PyArray_DATA(directions);
    pl_plane_fit *to = PyArray_DATA(out);
    Py_BEGIN_ALLOW_THREADS status =
        pl_plane_fits(terrain, &disc, d, (size_t)shape[0], baseline_m, to);
    Py_END_ALLOW_THREADS out = checked(out, status);
  }
  Py_DECREF((PyObject *)directions);
  return (PyObject *)out;
}

static PyObject *level_of_cell(PyObject *self, PyObject *cell) {
  int level;
  const double cell_m = PyFloat_AsDouble(cell);
  if (PyErr_Occurred() || level_of(((terrain_object *)self)->terrain, cell_m, &level) < 0)
    return NULL;
  return PyLong_FromLong(level);
}

static PyObject *cell_of_level(PyObject *self, PyObject *level) {
  const long k = PyLong_AsLong(level);
  if (PyErr_Occurred())
    return NULL;
  if (k < 0 || k >= PL_CUBE_LEVELS)
    return PyErr_Format(PyExc_ValueError, "level must be in [0, %d]", PL_CUBE_LEVELS - 1);
  const double radius_m = pl_terrain_radius_m(((terrain_object *)self)->terrain);
  return PyFloat_FromDouble(pl_cube_cell_m((int)k, radius_m));
}

static PyObject *relief_m(PyObject *self, PyObject *cell) {
  int level;
  const pl_terrain *terrain = ((terrain_object *)self)->terrain;
  const double cell_m = PyFloat_AsDouble(cell);
  if (PyErr_Occurred() || level_of(terrain, cell_m, &level) < 0)
    return NULL;
  return PyFloat_FromDouble(pl_terrain_relief_m(terrain, level));
}

static PyObject *get_bounds(PyObject *self, void *closure) {
  (void)closure;
  double low_m, high_m;
  pl_terrain_bounds(((terrain_object *)self)->terrain, &low_m, &high_m);
  return Py_BuildValue("(dd)", low_m, high_m);
}

static PyObject *get_finest(PyObject *self, void *closure) {
  (void)closure;
  return PyLong_FromLong(pl_terrain_finest_level(((terrain_object *)self)->terrain));
}

static PyObject *craters(PyObject *self, PyObject *args, PyObject *kwargs) {
  const pl_terrain *terrain = ((terrain_object *)self)->terrain;
  pl_py_crater_region at;
  if (pl_py_crater_region_of(args, kwargs, &at) < 0)
    return NULL;
  pl_crater *found;
  size_t count;
  pl_status status;
  Py_BEGIN_ALLOW_THREADS status =
      pl_terrain_craters(terrain, at.direction, at.radius_m, at.min_m, at.max_m, &found, &count);
  Py_END_ALLOW_THREADS return pl_py_crater_list(status, found, count);
}

static PyObject *rocks(PyObject *self, PyObject *ids) {
  return pl_py_rocks_find(((terrain_object *)self)->terrain, ids);
}

static PyObject *rock_surfaces(PyObject *self, PyObject *args) {
  return pl_py_rock_surfaces(((terrain_object *)self)->terrain, args);
}

static PyMethodDef terrain_methods[] = {
    {"craters", (PyCFunction)(void (*)(void))craters, METH_VARARGS | METH_KEYWORDS,
     "craters($self, direction, radius_m, min_diameter_m=0.0, max_diameter_m=1e300)\n--\n\n"
     "Craters of a region that are drawn."},
    {"rocks", rocks, METH_O, "rocks($self, ids, /)\n--\n\nRocks of these ids."},
    {"rock_surfaces", rock_surfaces, METH_VARARGS,
     "rock_surfaces($self, ids, eye, pixel_rad, /)\n--\n\nRocks of ids and points of them."},
    {"heights", (PyCFunction)(void (*)(void))heights, METH_VARARGS | METH_KEYWORDS,
     "heights($self, directions, cell_m=0.0)\n--\n\n(n,) heights, m."},
    {"block", (PyCFunction)(void (*)(void))block, METH_VARARGS | METH_KEYWORDS,
     "block($self, face, level, i0, j0, width, height)\n--\n\n(height, width) heights of nodes."},
    {"slopes", (PyCFunction)(void (*)(void))slopes, METH_VARARGS | METH_KEYWORDS,
     "slopes($self, directions, baseline_m)\n--\n\n(n, 3) slopes along the ground."},
    {"planes", (PyCFunction)(void (*)(void))planes, METH_VARARGS | METH_KEYWORDS,
     "planes($self, directions, baseline_m, points=32)\n--\n\n(n, 2) slope and RMS height of "
     "fitted "
     "planes."},
    {"level", level_of_cell, METH_O,
     "level($self, cell_m, /)\n--\n\nCoarsest level of cells of at most cell_m."},
    {"cell_m", cell_of_level, METH_O, "cell_m($self, level, /)\n--\n\nWidth of a level's cells."},
    {"relief_m", relief_m, METH_O,
     "relief_m($self, cell_m, /)\n--\n\nStandard deviation of detail finer than cells."},
    {NULL, NULL, 0, NULL},
};

static PyGetSetDef terrain_getset[] = {
    {"bounds", get_bounds, NULL, "Bounds of all heights, m.", NULL},
    {"finest_level", get_finest, NULL, "Level beyond which nothing is added.", NULL},
    {NULL, NULL, NULL, NULL, NULL},
};

static PyType_Slot terrain_slots[] = {
    {Py_tp_doc, "Terrain(radii_m, layers=(), detail=None, craters=None, rocks=None, "
                "albedo=None, roughness=None, roughness_baseline_m=0.0, "
                "known_craters=None, mask=None, patch=None, tracks=None, "
                "textures=None)\n--\n\nGround of a body."},
    {Py_tp_new, (void *)terrain_new},
    {Py_tp_dealloc, (void *)terrain_dealloc},
    {Py_tp_methods, terrain_methods},
    {Py_tp_getset, terrain_getset},
    {0, NULL},
};

PyType_Spec pl_py_terrain_spec = {"perilune._core.Terrain", sizeof(terrain_object), 0,
                                  Py_TPFLAGS_DEFAULT, terrain_slots};
