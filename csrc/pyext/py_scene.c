/* The type Scene: models, maps and label ids that are constant over frames. */
#include "pyext/py_types.h"

#include <string.h>

#include "base/memory.h"
#include "pyext/py_ground.h"

typedef struct scene_object {
  PyObject_HEAD pl_scene scene;
  PyObject *kept; /* list: objects that the scene borrows */
  PyObject
      *graphs; /* dict: index of an object -> tuple of its graphs; -1 - index of a body -> graph */
  /* Guarded by the GIL. held: number of frames being rendered. changing: a method is between its
   * checks and its end, and parses arguments, which may run arbitrary code. */
  int frozen, held, changing;
} scene_object;

static void scene_dealloc(PyObject *self) {
  PyTypeObject *type = Py_TYPE(self);
  pl_scene_clear(&((scene_object *)self)->scene);
  Py_XDECREF(((scene_object *)self)->kept);
  Py_XDECREF(((scene_object *)self)->graphs);
  ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
  Py_DECREF(type);
}

static int check_changing(const scene_object *self) {
  if (!self->changing)
    return 0;
  PyErr_SetString(PyExc_ValueError, "the scene is being changed, by another thread or by the code "
                                    "of an argument");
  return -1;
}

const pl_scene *pl_py_scene_freeze(PyObject *object) {
  if (!pl_py_is(object, (void *)scene_dealloc)) {
    PyErr_SetString(PyExc_TypeError, "scene must be a perilune._core.Scene");
    return NULL;
  }
  if (check_changing((scene_object *)object) < 0)
    return NULL;
  ((scene_object *)object)->frozen = 1;
  return &((scene_object *)object)->scene;
}

int pl_py_scene_hold(PyObject *scene) {
  if (check_changing((scene_object *)scene) < 0)
    return -1;
  ((scene_object *)scene)->held++;
  return 0;
}

void pl_py_scene_release(PyObject *scene) { ((scene_object *)scene)->held--; }

static PyObject *scene_new(PyTypeObject *type, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"levels", NULL};
  int levels;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "i:Scene", names, &levels))
    return NULL;
  scene_object *self = (scene_object *)((allocfunc)PyType_GetSlot(type, Py_tp_alloc))(type, 0);
  if (self == NULL)
    return NULL;
  self->kept = PyList_New(0);
  self->graphs = PyDict_New();
  const pl_status status = pl_scene_init(levels, &self->scene);
  if (self->kept == NULL || self->graphs == NULL || status != PL_OK) {
    Py_DECREF(self);
    return status != PL_OK ? pl_py_raise(status) : NULL;
  }
  return (PyObject *)self;
}

/* Body of a method of the scene; takes the method's arguments. */
typedef PyObject *(*change_fn)(scene_object *self, PyObject *args, PyObject *kwargs);

static int check_use(const scene_object *self, bool adds) {
  if (adds && self->frozen) {
    PyErr_SetString(PyExc_ValueError, "the scene is in use by a Renderer; make a new one");
    return -1;
  }
  if (self->held > 0) {
    PyErr_SetString(PyExc_ValueError, "a frame of the scene is being rendered");
    return -1;
  }
  return check_changing(self);
}

/* adds: not allowed once a renderer exists, as its memory is sized by the scene. Other changes are
 * allowed between frames. */
static PyObject *run_change(PyObject *object, PyObject *args, PyObject *kwargs, change_fn change,
                            bool adds) {
  scene_object *self = (scene_object *)object;
  if (check_use(self, adds) < 0)
    return NULL;
  self->changing = 1;
  PyObject *result = change(self, args, kwargs);
  self->changing = 0;
  return result;
}

static const pl_reflectance *find_reflectance(const char *name) {
  const pl_reflectance *found = pl_reflectance_find(name);
  if (found == NULL)
    PyErr_Format(PyExc_ValueError, "unknown reflectance '%s'; see perilune._core.REFLECTANCES",
                 name);
  return found;
}

/* Arguments of add_body that the core borrows and the scene keeps alive; each may be None. */
typedef struct body_arguments {
  PyObject *map, *regolith, *air, *shape, *rings, *cloud_map, *terrain;
} body_arguments;

static int borrow(const body_arguments *in, PyObject *kept, pl_body *out) {
  PyObject *const all[] = {in->map,   in->regolith,  in->air,    in->shape,
                           in->rings, in->cloud_map, in->terrain};
  if ((in->map != Py_None && (out->map = pl_py_map_of(in->map)) == NULL) ||
      (in->regolith != Py_None && (out->regolith_map = pl_py_grid_of(in->regolith)) == NULL) ||
      (in->air != Py_None && (out->air = pl_py_air_of(in->air)) == NULL) ||
      (in->shape != Py_None && (out->shape = pl_py_model_of(in->shape)) == NULL) ||
      (in->rings != Py_None && (out->rings = pl_py_rings_of(in->rings)) == NULL) ||
      (in->cloud_map != Py_None && (out->cloud_map = pl_py_map_of(in->cloud_map)) == NULL) ||
      (in->terrain != Py_None && (out->terrain = pl_py_terrain_of(in->terrain)) == NULL))
    return -1;
  for (size_t i = 0; i < sizeof all / sizeof *all; i++)
    if (PyList_Append(kept, all[i]) < 0)
      return -1;
  return 0;
}

static int copy_classes(PyObject *classes, int count, uint16_t *out) {
  const npy_intp levels[1] = {count};
  PyArrayObject *ids = pl_py_array(classes, "class_ids", NPY_UINT16, 1, levels);
  if (ids == NULL)
    return -1;
  memcpy(out, PyArray_DATA(ids), (size_t)count * sizeof *out);
  Py_DECREF((PyObject *)ids);
  return 0;
}

/* (level, class of rocks, class of craters); None: those of the body. */
static int parse_ground_labels(PyObject *given, int levels, pl_body *out) {
  pl_ground_labels *labels = &out->ground_labels;
  labels->apart = given != Py_None;
  if (!labels->apart)
    return 0;
  if (!PyTuple_Check(given)) {
    PyErr_SetString(PyExc_TypeError, "ground_labels: (level, rock, crater), or None");
    return -1;
  }
  int level, rock, crater;
  if (!PyArg_ParseTuple(given, "iii:ground_labels", &level, &rock, &crater))
    return -1;
  if (level < 0 || level >= levels || rock < 0 || rock > UINT16_MAX || crater < 0 ||
      crater > UINT16_MAX) {
    PyErr_Format(PyExc_ValueError, "ground_labels: level %d of %d, classes %d and %d", level,
                 levels, rock, crater);
    return -1;
  }
  labels->level = level;
  labels->rock = (uint16_t)rock;
  labels->crater = (uint16_t)crater;
  return 0;
}

/* Areas of a body's surface: (rasters, part_ids, class_ids), or None. `arrays` receives owned
 * references to the arrays that out->areas borrows. */
static int parse_areas(PyObject *given, int count, PyObject *kept, PyArrayObject *arrays[2],
                       pl_body *out) {
  PyObject *rasters, *part_ids, *class_ids;
  if (given == Py_None)
    return 0;
  if (!PyTuple_Check(given) ||
      !PyArg_ParseTuple(given, "O!OO:areas", &PyTuple_Type, &rasters, &part_ids, &class_ids)) {
    PyErr_SetString(PyExc_TypeError, "areas: (tuple of rasters, part_ids, class_ids), or None");
    return -1;
  }
  out->area_map.count = (size_t)PyTuple_Size(rasters);
  if (out->area_map.count < 1 || out->area_map.count > PL_AREA_RASTERS) {
    PyErr_Format(PyExc_ValueError, "areas: 1 to %d rasters", PL_AREA_RASTERS);
    return -1;
  }
  for (size_t k = 0; k < out->area_map.count; k++) {
    PyObject *raster = PyTuple_GetItem(rasters, (Py_ssize_t)k);
    if ((out->area_map.rasters[k] = pl_py_raster_of(raster)) == NULL ||
        PyList_Append(kept, raster) < 0)
      return -1;
  }
  npy_intp shape[2] = {-1, count};
  if ((arrays[0] = pl_py_array(part_ids, "part_ids", NPY_INT32, 1, shape)) == NULL)
    return -1;
  shape[0] = PyArray_DIM(arrays[0], 0);
  if ((arrays[1] = pl_py_array(class_ids, "class_ids", NPY_UINT16, 2, shape)) == NULL)
    return -1;
  out->areas = (pl_part_table){.count = (size_t)shape[0],
                               .part_ids = PyArray_DATA(arrays[0]),
                               .class_ids = PyArray_DATA(arrays[1])};
  return 0;
}

static char *body_names[] = {"name",          "map",           "map_center_lon_rad",
                             "reflectance",   "instance_id",   "part_id",
                             "class_ids",     "regolith_map",  "air",
                             "shape",         "rings",         "cloud_map",
                             "ground",        "geodetic",      "geodetic_clouds",
                             "dressed",       "terrain",       "cells_per_pixel",
                             "finest_cell_m", "ground_labels", "crater_criteria",
                             "areas",         "obj_id",        NULL};

static PyObject *add_body(scene_object *self, PyObject *args, PyObject *kwargs) {
  PyObject *classes, *ground_labels = Py_None, *areas = Py_None, *ground = Py_None;
  PyArrayObject *arrays[2] = {NULL, NULL};
  body_arguments in = {
      .shape = Py_None, .rings = Py_None, .cloud_map = Py_None, .terrain = Py_None};
  const char *name, *reflectance;
  int geodetic = 0, geodetic_clouds = 0, dressed = 0;
  pl_body body = {.cells_per_pixel = 1.0, .finest_cell_m = 0.01, .craters = PL_CRATER_CRITERIA};
  if (!PyArg_ParseTupleAndKeywords(
          args, kwargs, "sOdsiiOOO|$OOOOpppOddO(ddd)Oi:add_body", body_names, &name, &in.map,
          &body.map_center_lon_rad, &reflectance, &body.instance_id, &body.part_id, &classes,
          &in.regolith, &in.air, &in.shape, &in.rings, &in.cloud_map, &ground, &geodetic,
          &geodetic_clouds, &dressed, &in.terrain, &body.cells_per_pixel, &body.finest_cell_m,
          &ground_labels, &body.craters.least_px, &body.craters.least_depth,
          &body.craters.least_kept, &areas, &body.obj_id))
    return NULL;
  body.dressed = dressed != 0 && in.shape != Py_None;
  body.geodetic = geodetic != 0;
  body.geodetic_clouds = geodetic_clouds != 0;
  body.name = (char *)(uintptr_t)name; /* copied by the scene */
  body.reflectance = find_reflectance(reflectance);
  PyObject *result = NULL;
  if (body.reflectance != NULL && borrow(&in, self->kept, &body) == 0 &&
      pl_py_ground_parse(ground, self->kept, &body.ground) == 0 &&
      copy_classes(classes, self->scene.levels, body.class_ids) == 0 &&
      parse_ground_labels(ground_labels, self->scene.levels, &body) == 0 &&
      parse_areas(areas, self->scene.levels, self->kept, arrays, &body) == 0) {
    const pl_status status = pl_scene_add_body(&self->scene, &body);
    result = status == PL_OK ? PyLong_FromSize_t(self->scene.body_count - 1) : pl_py_raise(status);
  }
  Py_XDECREF((PyObject *)arrays[0]);
  Py_XDECREF((PyObject *)arrays[1]);
  return result;
}

/* Arguments of add_object, and the arrays made from them (owned references). */
typedef struct object_arguments {
  PyObject *offset, *parts, *classes, *triangle_part; /* borrowed; triangle_part may be None */
  PyArrayObject *arrays[4];                           /* in the same order; the last may be NULL */
} object_arguments;

static int object_arrays(const scene_object *self, const pl_model *model, object_arguments *in) {
  const npy_intp three[1] = {3}, triangles[1] = {(npy_intp)model->triangle_count};
  const bool cut = in->triangle_part != Py_None;
  npy_intp part[1] = {cut ? -1 : (npy_intp)model->part_count};
  if ((in->arrays[0] = pl_py_array(in->offset, "offset", NPY_DOUBLE, 1, three)) == NULL ||
      (in->arrays[1] = pl_py_array(in->parts, "part_ids", NPY_INT32, 1, part)) == NULL)
    return -1;
  const npy_intp table[2] = {PyArray_DIM(in->arrays[1], 0), self->scene.levels};
  if ((in->arrays[2] = pl_py_array(in->classes, "class_ids", NPY_UINT16, 2, table)) == NULL)
    return -1;
  if (cut && (in->arrays[3] = pl_py_array(in->triangle_part, "triangle_part", NPY_UINT32, 1,
                                          triangles)) == NULL)
    return -1;
  return 0;
}

static PyObject *add_object(scene_object *self, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"name",     "model",     "offset",        "obj_id", "instance_id",
                          "part_ids", "class_ids", "triangle_part", NULL};
  PyObject *py_model, *added = NULL;
  object_arguments in = {.triangle_part = Py_None};
  const char *name;
  int obj_id, instance_id;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "sOOiiOO|$O:add_object", names, &name, &py_model,
                                   &in.offset, &obj_id, &instance_id, &in.parts, &in.classes,
                                   &in.triangle_part))
    return NULL;
  const pl_model *model = pl_py_model_of(py_model);
  if (model == NULL)
    return NULL;
  if (object_arrays(self, model, &in) == 0 && PyList_Append(self->kept, py_model) == 0) {
    const double *o = PyArray_DATA(in.arrays[0]);
    const pl_part_table table = {
        .count = (size_t)PyArray_DIM(in.arrays[1], 0),
        .part_ids = PyArray_DATA(in.arrays[1]),
        .class_ids = PyArray_DATA(in.arrays[2]),
        .triangle_part = in.arrays[3] != NULL ? PyArray_DATA(in.arrays[3]) : NULL,
    };
    const pl_status status = pl_scene_add_object(
        &self->scene, name, model, (pl_vec3){o[0], o[1], o[2]}, obj_id, instance_id, &table);
    added = status == PL_OK ? PyLong_FromSize_t(self->scene.craft_count - 1) : pl_py_raise(status);
  }
  for (int i = 0; i < 4; i++)
    Py_XDECREF((PyObject *)in.arrays[i]);
  return added;
}

/* Returns the borrowed graphs of a tuple; NULL with an exception. */
static const pl_graph **graphs_of(PyObject *tuple) {
  const size_t count = (size_t)PyTuple_Size(tuple);
  void *memory;
  const pl_status status = pl_alloc_or_fail(count, sizeof(pl_graph *), "graphs", &memory);
  if (status != PL_OK) {
    pl_py_raise(status);
    return NULL;
  }
  const pl_graph **graphs = memory;
  for (size_t i = 0; i < count; i++) {
    graphs[i] = pl_py_graph_of(PyTuple_GetItem(tuple, (Py_ssize_t)i));
    if (graphs[i] == NULL) {
      pl_free(memory);
      return NULL;
    }
  }
  return graphs;
}

/* Replaces an object's graphs in the scene by a tuple of graphs, and keeps that instead of the
 * former one. Both are kept alive during the change, so that a failure leaves no borrowed graph
 * without an owner. */
static int replace_graphs(scene_object *self, size_t index, PyObject *tuple,
                          PyArrayObject *triangles) {
  int result = -1;
  const pl_graph **graphs = graphs_of(tuple);
  PyObject *key = graphs != NULL ? PyLong_FromSize_t(index) : NULL;
  PyObject *before = key != NULL ? PyDict_GetItemWithError(self->graphs, key) : NULL;
  before = Py_NewRef(before != NULL ? before : Py_None);
  PyObject *both = PyErr_Occurred() ? NULL : PyTuple_Pack(2, tuple, before);
  if (both != NULL && PyDict_SetItem(self->graphs, key, both) == 0) {
    const pl_status status = pl_scene_set_materials(
        &self->scene, index, graphs, (size_t)PyTuple_Size(tuple), PyArray_DATA(triangles));
    result = PyDict_SetItem(self->graphs, key, status == PL_OK ? tuple : before);
    if (status != PL_OK) {
      pl_py_raise(status);
      result = -1;
    }
  }
  Py_XDECREF(both);
  Py_DECREF(before);
  Py_XDECREF(key);
  pl_free((void *)graphs);
  return result;
}

static PyObject *set_materials(scene_object *self, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"object", "graphs", "triangle_graph", NULL};
  Py_ssize_t index;
  PyObject *tuple, *triangles;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "nO!O:set_materials", names, &index, &PyTuple_Type,
                                   &tuple, &triangles))
    return NULL;
  if (index < 0 || (size_t)index >= self->scene.craft_count) {
    PyErr_Format(PyExc_ValueError, "no object %zd", index);
    return NULL;
  }
  const npy_intp shape[1] = {(npy_intp)self->scene.objects[index].model->triangle_count};
  PyArrayObject *array = pl_py_array(triangles, "triangle_graph", NPY_INT32, 1, shape);
  const int failed = array == NULL || replace_graphs(self, (size_t)index, tuple, array) < 0;
  Py_XDECREF((PyObject *)array);
  return failed ? NULL : Py_NewRef(Py_None);
}

static PyObject *set_body_graph(scene_object *self, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"body", "graph", NULL};
  Py_ssize_t index;
  PyObject *py_graph;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "nO:set_body_graph", names, &index, &py_graph))
    return NULL;
  if (index < 0 || (size_t)index >= self->scene.body_count) {
    PyErr_Format(PyExc_ValueError, "no body %zd", index);
    return NULL;
  }
  const pl_graph *graph = NULL;
  if (py_graph != Py_None && (graph = pl_py_graph_of(py_graph)) == NULL)
    return NULL;
  /* Keys of bodies count from -1 downwards. The former graph may be released: nothing uses it after
   * the call. */
  PyObject *key = PyLong_FromSsize_t(-1 - index);
  PyObject *before = Py_XNewRef(key != NULL ? PyDict_GetItemWithError(self->graphs, key) : NULL);
  const int failed =
      key == NULL || PyErr_Occurred() || PyDict_SetItem(self->graphs, key, py_graph) < 0;
  if (!failed)
    pl_body_set_graph(&self->scene.bodies[index], graph);
  Py_XDECREF(before);
  Py_XDECREF(key);
  return failed ? NULL : Py_NewRef(Py_None);
}

static PyObject *articulate(scene_object *self, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"object", "nodes", NULL};
  const npy_intp any[1] = {-1};
  Py_ssize_t index;
  PyObject *nodes;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "nO:articulate", names, &index, &nodes))
    return NULL;
  PyArrayObject *array = pl_py_array(nodes, "nodes", NPY_INT, 1, any);
  if (array == NULL)
    return NULL;
  const pl_status status = pl_scene_articulate(&self->scene, index < 0 ? SIZE_MAX : (size_t)index,
                                               PyArray_DATA(array), (size_t)PyArray_DIM(array, 0));
  Py_DECREF((PyObject *)array);
  return status == PL_OK ? Py_NewRef(Py_None) : pl_py_raise(status);
}

static PyObject *scene_add_body(PyObject *self, PyObject *args, PyObject *kwargs) {
  return run_change(self, args, kwargs, add_body, true);
}

static PyObject *scene_add_object(PyObject *self, PyObject *args, PyObject *kwargs) {
  return run_change(self, args, kwargs, add_object, true);
}

static PyObject *scene_set_materials(PyObject *self, PyObject *args, PyObject *kwargs) {
  return run_change(self, args, kwargs, set_materials, false);
}

static PyObject *scene_set_body_graph(PyObject *self, PyObject *args, PyObject *kwargs) {
  return run_change(self, args, kwargs, set_body_graph, false);
}

static PyObject *scene_articulate(PyObject *self, PyObject *args, PyObject *kwargs) {
  return run_change(self, args, kwargs, articulate, true);
}

static PyMethodDef scene_methods[] = {
    {"add_body", (PyCFunction)(void (*)(void))scene_add_body, METH_VARARGS | METH_KEYWORDS,
     "Adds a body; returns its index."},
    {"add_object", (PyCFunction)(void (*)(void))scene_add_object, METH_VARARGS | METH_KEYWORDS,
     "Adds an instance of a model; returns its index."},
    {"set_materials", (PyCFunction)(void (*)(void))scene_set_materials,
     METH_VARARGS | METH_KEYWORDS, "Puts graphs on an object's triangles, also between frames."},
    {"set_body_graph", (PyCFunction)(void (*)(void))scene_set_body_graph,
     METH_VARARGS | METH_KEYWORDS, "Replaces a body's graph, also between frames."},
    {"articulate", (PyCFunction)(void (*)(void))scene_articulate, METH_VARARGS | METH_KEYWORDS,
     "Lets nodes of an object's model move."},
    {NULL, NULL, 0, NULL},
};

static PyType_Slot scene_slots[] = {
    {Py_tp_doc, "Scene(levels)\n--\n\nWhat does not change from frame to frame."},
    {Py_tp_new, (void *)scene_new},
    {Py_tp_dealloc, (void *)scene_dealloc},
    {Py_tp_methods, scene_methods},
    {0, NULL},
};

PyType_Spec pl_py_scene_spec = {"perilune._core.Scene", sizeof(scene_object), 0, Py_TPFLAGS_DEFAULT,
                                scene_slots};
