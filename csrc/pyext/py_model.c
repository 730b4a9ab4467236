/* The type Model: a glTF file or the shape of a body; immutable. */
#include "geom/articulation.h"
#include "pyext/py_types.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "geom/components.h"
#include "geom/crease.h"
#include "geom/shape.h"
#include "geom/texture.h"
#include "io/gltf.h"
#include "math/color.h"
#include "shade/material_surface.h"
#include "shade/presence.h"
#include "trace/backing.h"

typedef struct model_object {
  PyObject_HEAD pl_model *model; /* owned */
  PyObject *path;                /* str */
  PyObject *source;              /* Model that owns the borrowed textures, or NULL */
} model_object;

static void model_dealloc(PyObject *self) {
  model_object *model = (model_object *)self;
  PyTypeObject *type = Py_TYPE(self);
  pl_model_destroy(model->model);
  Py_XDECREF(model->path);
  Py_XDECREF(model->source);
  ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
  Py_DECREF(type);
}

const pl_model *pl_py_model_of(PyObject *object) {
  if (!pl_py_is(object, (void *)model_dealloc)) {
    PyErr_SetString(PyExc_TypeError, "model must be a perilune._core.Model");
    return NULL;
  }
  return ((model_object *)object)->model;
}

/* Options for loading a file. */
typedef struct reading {
  double crease_rad;
  bool stretched;
  double stretch[3];
  /* borrowed: a function of a material's name and sidedness; None keeps those of the file */
  PyObject *sides;
} reading;

static pl_status load(const char *path, const reading *how, pl_model **out) {
  size_t split;
  PL_TRY(pl_gltf_load(path, how->stretched ? how->stretch : NULL, out));
  return pl_model_crease(*out, how->crease_rad, &split); /* the object already owns the model */
}

/* Calls `sides` for each material. Transmissive solids stay double-sided. */
static int set_sides(PyObject *sides, pl_model *model) {
  for (size_t i = 0; i < model->material_count; i++) {
    pl_material *material = &model->materials[i];
    PyObject *answer = PyObject_CallFunction(sides, "sO", material->name,
                                             material->double_sided ? Py_True : Py_False);
    const int both = answer != NULL ? PyObject_IsTrue(answer) : -1;
    Py_XDECREF(answer);
    if (both < 0)
      return -1;
    if (material->layers.solid && material->layers.transmission > 0.0f)
      continue;
    material->dark_behind = both != 0 && !material->double_sided;
    material->double_sided = both != 0;
  }
  return 0;
}

static int parse_reading(PyObject *stretch, reading *how) {
  if (!(how->crease_rad >= 0.0)) {
    PyErr_SetString(PyExc_ValueError, "crease_angle_rad must not be negative");
    return -1;
  }
  how->stretched = stretch != Py_None;
  if (!how->stretched)
    return 0;
  const npy_intp shape[1] = {3};
  PyArrayObject *array = pl_py_array(stretch, "stretch", NPY_DOUBLE, 1, shape);
  if (array == NULL)
    return -1;
  memcpy(how->stretch, PyArray_DATA(array), sizeof how->stretch);
  Py_DECREF(array);
  for (int i = 0; i < 3; i++)
    if (!(how->stretch[i] > 0.0) || !isfinite(how->stretch[i])) {
      PyErr_SetString(PyExc_ValueError, "stretch must be positive and finite");
      return -1;
    }
  return 0;
}

static PyObject *model_new(PyTypeObject *type, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"path", "crease_angle_rad", "stretch", "sides", NULL};
  PyObject *path, *stretch = Py_None, *bytes = NULL;
  reading how = {.crease_rad = PL_PI, .sides = Py_None};
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "U|dOO:Model", names, &path, &how.crease_rad,
                                   &stretch, &how.sides) ||
      parse_reading(stretch, &how) < 0 || !PyUnicode_FSConverter(path, &bytes))
    return NULL;
  model_object *self = (model_object *)((allocfunc)PyType_GetSlot(type, Py_tp_alloc))(type, 0);
  if (self == NULL) {
    Py_DECREF(bytes);
    return NULL;
  }
  pl_status status;
  const char *name = PyBytes_AsString(bytes);
  Py_BEGIN_ALLOW_THREADS status = load(name, &how, &self->model);
  Py_END_ALLOW_THREADS Py_DECREF(bytes);
  const bool answered =
      status != PL_OK || how.sides == Py_None || set_sides(how.sides, self->model) == 0;
  if (status == PL_OK && answered) {
    Py_BEGIN_ALLOW_THREADS status = pl_backing_find(self->model);
    Py_END_ALLOW_THREADS
  }
  if (!answered || status != PL_OK) {
    Py_DECREF(self);
    return answered ? pl_py_raise(status) : NULL;
  }
  Py_INCREF(path);
  self->path = path;
  return (PyObject *)self;
}

/* Arguments of of_mesh, and the arrays made from them (new references, or NULL). */
typedef struct mesh_arguments {
  PyObject *name, *positions, *indices, *source, *corners, *faces; /* the last three may be None */
  int one_sided;
  PyArrayObject *arrays[4]; /* positions, indices, corners, faces */
} mesh_arguments;

static int mesh_arrays(mesh_arguments *in) {
  const npy_intp rows[2] = {-1, 3};
  in->arrays[0] = pl_py_array(in->positions, "positions", NPY_FLOAT, 2, rows);
  if (in->arrays[0] != NULL)
    in->arrays[1] = pl_py_array(in->indices, "indices", NPY_UINT32, 2, rows);
  if (in->arrays[1] == NULL || in->source == Py_None)
    return in->arrays[1] != NULL ? 0 : -1;
  const npy_intp shape[2] = {PyArray_DIM(in->arrays[1], 0), 3};
  in->arrays[2] = pl_py_array(in->corners, "corners", NPY_UINT32, 2, shape);
  if (in->arrays[2] != NULL)
    in->arrays[3] = pl_py_array(in->faces, "faces", NPY_UINT32, 1, shape);
  return in->arrays[3] != NULL ? 0 : -1;
}

static int fill_mesh(model_object *self, const mesh_arguments *in, const pl_model *source) {
  const char *name = PyUnicode_AsUTF8AndSize(in->name, NULL);
  if (name == NULL)
    return -1;
  pl_status status = pl_shape_create(
      name, PyArray_DATA(in->arrays[0]), (size_t)PyArray_DIM(in->arrays[0], 0),
      PyArray_DATA(in->arrays[1]), (size_t)PyArray_DIM(in->arrays[1], 0), &self->model);
  self->path = Py_NewRef(in->name);
  if (status == PL_OK && source != NULL) {
    self->source = Py_NewRef(in->source);
    status = pl_shape_dress(self->model, source, PyArray_DATA(in->arrays[2]),
                            PyArray_DATA(in->arrays[3]));
  }
  if (status == PL_OK && in->one_sided)
    pl_shape_make_one_sided(self->model);
  return status == PL_OK ? 0 : (pl_py_raise(status), -1);
}

/* Creates a model of the type `self` from a mesh. */
static PyObject *model_of_mesh(PyObject *self, PyObject *args) {
  mesh_arguments in = {.source = Py_None, .corners = Py_None, .faces = Py_None};
  const pl_model *source = NULL;
  if (!PyArg_ParseTuple(args, "UOO|pOOO:of_mesh", &in.name, &in.positions, &in.indices,
                        &in.one_sided, &in.source, &in.corners, &in.faces) ||
      (in.source != Py_None && (source = pl_py_model_of(in.source)) == NULL))
    return NULL;
  PyTypeObject *type = (PyTypeObject *)self;
  model_object *out = NULL;
  if (mesh_arrays(&in) == 0)
    out = (model_object *)((allocfunc)PyType_GetSlot(type, Py_tp_alloc))(type, 0);
  if (out != NULL && fill_mesh(out, &in, source) < 0)
    Py_CLEAR(out);
  for (int i = 0; i < 4; i++)
    Py_XDECREF((PyObject *)in.arrays[i]);
  return (PyObject *)out;
}

PyObject *pl_py_gltf_graphs(PyObject *module, PyObject *path) {
  (void)module;
  PyObject *bytes = NULL;
  if (!PyUnicode_FSConverter(path, &bytes))
    return NULL;
  pl_status status;
  char *text = NULL;
  const char *name = PyBytes_AsString(bytes);
  Py_BEGIN_ALLOW_THREADS status = pl_gltf_graphs(name, &text);
  Py_END_ALLOW_THREADS Py_DECREF(bytes);
  if (status != PL_OK)
    return pl_py_raise(status);
  PyObject *out = PyUnicode_DecodeUTF8(text, (Py_ssize_t)strlen(text), "replace");
  pl_free(text);
  return out;
}

static const pl_model *of(PyObject *self) { return ((model_object *)self)->model; }

static PyObject *get_path(PyObject *self, void *closure) {
  (void)closure;
  return Py_NewRef(((model_object *)self)->path);
}

static PyObject *get_triangle_count(PyObject *self, void *closure) {
  (void)closure;
  return PyLong_FromSize_t(of(self)->triangle_count);
}

static PyObject *get_vertex_count(PyObject *self, void *closure) {
  (void)closure;
  return PyLong_FromSize_t(of(self)->vertex_count);
}

static PyObject *get_nbytes(PyObject *self, void *closure) {
  (void)closure;
  return PyLong_FromSize_t(pl_model_bytes(of(self)));
}

static PyObject *get_bounds(PyObject *self, void *closure) {
  (void)closure;
  npy_intp shape[2] = {2, 3};
  PyObject *array = PyArray_SimpleNew(2, shape, NPY_DOUBLE);
  if (array == NULL)
    return NULL;
  double *out = PyArray_DATA((PyArrayObject *)array);
  const pl_model *m = of(self);
  const pl_vec3 low = {m->bounds_min[0], m->bounds_min[1], m->bounds_min[2]};
  const pl_vec3 high = {m->bounds_max[0], m->bounds_max[1], m->bounds_max[2]};
  const pl_vec3 a = pl_model_point(m, low), b = pl_model_point(m, high);
  const double bounds[6] = {a.x, a.y, a.z, b.x, b.y, b.z};
  memcpy(out, bounds, sizeof bounds);
  return array;
}

static PyObject *get_stretch(PyObject *self, void *closure) {
  (void)closure;
  npy_intp shape[1] = {3};
  PyObject *array = PyArray_SimpleNew(1, shape, NPY_DOUBLE);
  if (array == NULL)
    return NULL;
  const pl_affine base = pl_nodes_base(&of(self)->nodes);
  const double factors[3] = {base.m.row[0].x, base.m.row[1].y, base.m.row[2].z};
  memcpy(PyArray_DATA((PyArrayObject *)array), factors, sizeof factors);
  return array;
}

static PyObject *get_parts(PyObject *self, void *closure) {
  (void)closure;
  const pl_model *model = of(self);
  PyObject *parts = PyTuple_New((Py_ssize_t)model->part_count);
  for (size_t i = 0; parts != NULL && i < model->part_count; i++) {
    const pl_part *part = &model->parts[i];
    PyObject *item = Py_BuildValue("{s:s,s:s,s:i}", "name", part->name, "material",
                                   model->materials[part->material].name, "node", part->node);
    if (item == NULL)
      Py_CLEAR(parts);
    else
      PyTuple_SetItem(parts, (Py_ssize_t)i, item);
  }
  return parts;
}

/* Converts `list`, or NULL, to a tuple; steals the reference. */
static PyObject *tuple_of(PyObject *list) {
  PyObject *tuple = list != NULL ? PyList_AsTuple(list) : NULL;
  Py_XDECREF(list);
  return tuple;
}

/* Appends `item` and steals its reference; clears the list on failure. */
static void append(PyObject **list, PyObject *item) {
  if (*list != NULL && (item == NULL || PyList_Append(*list, item) < 0))
    Py_CLEAR(*list);
  Py_XDECREF(item);
}

static PyObject *get_nodes(PyObject *self, void *closure) {
  (void)closure;
  const pl_nodes *nodes = &of(self)->nodes;
  PyObject *list = PyList_New(0);
  for (size_t i = 0; i < nodes->count; i++) {
    pl_node_frame frame;
    const bool regular = pl_node_frame_find(of(self), (int)i, &frame) == PL_OK;
    const pl_vec3 at = regular ? frame.origin : (pl_vec3){NAN, NAN, NAN};
    append(&list, Py_BuildValue("{s:s,s:i,s:(ddd)}", "name", nodes->items[i].name, "parent",
                                nodes->items[i].parent, "origin", at.x, at.y, at.z));
  }
  return tuple_of(list);
}

static PyObject *animation_nodes(const pl_animation *animation) {
  PyObject *set = PySet_New(NULL);
  for (size_t i = 0; set != NULL && i < animation->count; i++) {
    PyObject *node = PyLong_FromLong(animation->tracks[i].node);
    if (node == NULL || PySet_Add(set, node) < 0)
      Py_CLEAR(set);
    Py_XDECREF(node);
  }
  PyObject *list = set != NULL ? PySequence_List(set) : NULL;
  Py_XDECREF(set);
  if (list != NULL && PyList_Sort(list) < 0)
    Py_CLEAR(list);
  return tuple_of(list);
}

static PyObject *get_animations(PyObject *self, void *closure) {
  (void)closure;
  PyObject *list = PyList_New(0);
  for (size_t i = 0; i < of(self)->animation_count; i++) {
    const pl_animation *animation = &of(self)->animations[i];
    PyObject *nodes = animation_nodes(animation);
    append(&list, nodes == NULL
                      ? NULL
                      : Py_BuildValue("{s:s,s:d,s:N}", "name", animation->name, "duration_s",
                                      animation->stop_s - animation->start_s, "nodes", nodes));
  }
  return tuple_of(list);
}

static PyObject *get_materials(PyObject *self, void *closure) {
  (void)closure;
  const pl_model *model = of(self);
  PyObject *names = PyTuple_New((Py_ssize_t)model->material_count);
  for (size_t i = 0; names != NULL && i < model->material_count; i++) {
    PyObject *name = PyUnicode_FromString(model->materials[i].name);
    if (name == NULL)
      Py_CLEAR(names);
    else
      PyTuple_SetItem(names, (Py_ssize_t)i, name);
  }
  return names;
}

static PyObject *get_warnings(PyObject *self, void *closure) {
  (void)closure;
  PyObject *text = PyUnicode_FromString(of(self)->warnings);
  PyObject *lines = text != NULL ? PyUnicode_Splitlines(text, 0) : NULL;
  PyObject *tuple = lines != NULL ? PyList_AsTuple(lines) : NULL;
  Py_XDECREF(text);
  Py_XDECREF(lines);
  return tuple;
}

/* Stores a new array with a copy of `values` in `dict` under `key`. */
static int put_copy(PyObject *dict, const char *key, const void *values, size_t rows, int columns,
                    int type) {
  npy_intp shape[2] = {(npy_intp)rows, columns};
  if (values == NULL)
    return 0;
  PyObject *array = PyArray_SimpleNew(columns > 0 ? 2 : 1, shape, type);
  if (array == NULL)
    return -1;
  memcpy(PyArray_DATA((PyArrayObject *)array), values,
         (size_t)PyArray_NBYTES((PyArrayObject *)array));
  const int failed = PyDict_SetItemString(dict, key, array);
  Py_DECREF(array);
  return failed;
}

/* Stores the positions in model units. */
static int put_positions(PyObject *dict, const pl_model *m) {
  npy_intp shape[2] = {(npy_intp)m->vertex_count, 3};
  PyObject *array = PyArray_SimpleNew(2, shape, NPY_DOUBLE);
  if (array == NULL)
    return -1;
  double *out = PyArray_DATA((PyArrayObject *)array);
  for (size_t v = 0; v < m->vertex_count; v++) {
    const float *p = m->positions + 3 * v;
    const pl_vec3 at = pl_model_point(m, (pl_vec3){p[0], p[1], p[2]});
    memcpy(out + 3 * v, (const double[3]){at.x, at.y, at.z}, 3 * sizeof *out);
  }
  const int failed = PyDict_SetItemString(dict, "positions", array);
  Py_DECREF(array);
  return failed;
}

/* Mean colour of a triangle's material as sRGB bytes, for viewers of exported models. */
static void triangle_color(const pl_model *model, size_t triangle, uint8_t out[3]) {
  const pl_material *material =
      &model->materials[model->parts[model->triangle_part[triangle]].material];
  float mean[4] = {1.0f, 1.0f, 1.0f, 1.0f};
  if (material->base_color_map.texture >= 0)
    pl_texture_mean(model->textures[material->base_color_map.texture], mean);
  for (int k = 0; k < 3; k++) {
    const float linear = fminf(fmaxf(mean[k] * material->base_color[k], 0.0f), 1.0f);
    out[k] = (uint8_t)(255.0f * pl_srgb_encode(linear) + 0.5f);
  }
}

static int put_triangle_colors(PyObject *dict, const pl_model *model) {
  npy_intp shape[2] = {(npy_intp)model->triangle_count, 3};
  PyObject *array = PyArray_SimpleNew(2, shape, NPY_UINT8);
  if (array == NULL)
    return -1;
  uint8_t *out = PyArray_DATA((PyArrayObject *)array);
  for (size_t t = 0; t < model->triangle_count; t++)
    triangle_color(model, t, out + 3 * t);
  const int failed = PyDict_SetItemString(dict, "triangle_color", array);
  Py_DECREF(array);
  return failed;
}

static PyObject *model_mesh(PyObject *self, PyObject *unused) {
  (void)unused;
  const pl_model *m = of(self);
  PyObject *dict = PyDict_New();
  if (dict == NULL)
    return NULL;
  if (put_positions(dict, m) < 0 ||
      put_copy(dict, "normals", m->normals, m->vertex_count, 3, NPY_FLOAT32) < 0 ||
      put_copy(dict, "uv", m->uvs[0], m->vertex_count, 2, NPY_FLOAT32) < 0 ||
      put_copy(dict, "indices", m->indices, m->triangle_count, 3, NPY_UINT32) < 0 ||
      put_copy(dict, "triangle_part", m->triangle_part, m->triangle_count, 0, NPY_UINT32) < 0 ||
      put_triangle_colors(dict, m) < 0)
    Py_CLEAR(dict);
  return dict;
}

static PyObject *put_new(PyObject *dict, const char *key, npy_intp count, int type) {
  PyObject *array = dict != NULL ? PyArray_SimpleNew(1, &count, type) : NULL;
  const int failed = array != NULL ? PyDict_SetItemString(dict, key, array) : -1;
  Py_XDECREF(array); /* the dictionary owns it */
  return failed == 0 ? array : NULL;
}

static PyObject *model_surfaces(PyObject *self, PyObject *unused) {
  (void)unused;
  const pl_model *m = of(self);
  PyObject *dict = PyDict_New();
  PyObject *sides = put_new(dict, "double_sided", (npy_intp)m->triangle_count, NPY_BOOL);
  PyObject *presence =
      sides != NULL ? put_new(dict, "presence", (npy_intp)m->triangle_count, NPY_UINT8) : NULL;
  if (presence == NULL) {
    Py_XDECREF(dict);
    return NULL;
  }
  npy_bool *double_sided = PyArray_DATA((PyArrayObject *)sides);
  for (size_t t = 0; t < m->triangle_count; t++)
    double_sided[t] = pl_back_is_there(m, (uint32_t)t);
  uint8_t *out = PyArray_DATA((PyArrayObject *)presence);
  Py_BEGIN_ALLOW_THREADS pl_presence_find(m, out);
  Py_END_ALLOW_THREADS return dict;
}

static PyObject *model_components(PyObject *self, PyObject *unused) {
  (void)unused;
  npy_intp shape[1] = {(npy_intp)of(self)->triangle_count};
  PyObject *array = PyArray_SimpleNew(1, shape, NPY_UINT32);
  if (array == NULL)
    return NULL;
  size_t count;
  const pl_status status =
      pl_components_find(of(self), PyArray_DATA((PyArrayObject *)array), &count);
  if (status == PL_OK)
    return array;
  Py_DECREF(array);
  return pl_py_raise(status);
}

static PyObject *model_winding(PyObject *self, PyObject *points) {
  const npy_intp rows[2] = {-1, 3};
  PyArrayObject *array = pl_py_array(points, "points", NPY_DOUBLE, 2, rows);
  npy_intp shape[1] = {array != NULL ? PyArray_DIM(array, 0) : 0};
  PyObject *out = array != NULL ? PyArray_SimpleNew(1, shape, NPY_DOUBLE) : NULL;
  const double *p = array != NULL ? PyArray_DATA(array) : NULL;
  for (npy_intp i = 0; out != NULL && i < shape[0]; i++)
    ((double *)PyArray_DATA((PyArrayObject *)out))[i] =
        pl_shape_winding(of(self), (pl_vec3){p[3 * i], p[3 * i + 1], p[3 * i + 2]});
  Py_XDECREF((PyObject *)array);
  return out;
}

static PyGetSetDef model_getset[] = {
    {"path", get_path, NULL, "Path of the file, or the name given to of_mesh.", NULL},
    {"triangle_count", get_triangle_count, NULL, NULL, NULL},
    {"vertex_count", get_vertex_count, NULL, NULL, NULL},
    {"nbytes", get_nbytes, NULL, NULL, NULL},
    {"bounds", get_bounds, NULL, "(2, 3) smallest and largest coordinates, model units.", NULL},
    {"stretch", get_stretch, NULL, "(3,) factors along its axes by which it is stretched.", NULL},
    {"parts", get_parts, NULL, "Name and material of each part.", NULL},
    {"nodes", get_nodes, NULL, "Name and parent of each node.", NULL},
    {"animations", get_animations, NULL, "Name, duration and nodes of each animation.", NULL},
    {"materials", get_materials, NULL, "Names of the materials.", NULL},
    {"warnings", get_warnings, NULL, "What the loader repaired or skipped.", NULL},
    {NULL, NULL, NULL, NULL, NULL},
};

static PyMethodDef model_methods[] = {
    {"mesh", model_mesh, METH_NOARGS, "Copies of the mesh's arrays, by name."},
    {"surfaces", model_surfaces, METH_NOARGS, "Sides and presence of each triangle."},
    {"of_mesh", model_of_mesh, METH_VARARGS | METH_CLASS, "The shape of a body, of arrays."},
    {"winding", model_winding, METH_O, "How often the surface goes around points."},
    {"components", model_components, METH_NOARGS, "Connected component of each triangle."},
    {NULL, NULL, 0, NULL},
};

static PyType_Slot model_slots[] = {
    {Py_tp_doc, "Model(path, crease_angle_rad=pi, stretch=None, sides=None)\n--\n\nA spacecraft "
                "model read from "
                ".gltf or .glb; immutable."},
    {Py_tp_new, (void *)model_new},
    {Py_tp_dealloc, (void *)model_dealloc},
    {Py_tp_getset, model_getset},
    {Py_tp_methods, model_methods},
    {0, NULL},
};

PyType_Spec pl_py_model_spec = {"perilune._core.Model", sizeof(model_object), 0, Py_TPFLAGS_DEFAULT,
                                model_slots};
