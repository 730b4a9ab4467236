/* The type Graph, and the table of node kinds. */
#include "pyext/py_types.h"

#include <string.h>

#include "base/memory.h"
#include "math/sampler.h"
#include "pyext/py_read.h"
#include "shade/graph_classes.h"
#include "shade/presence.h"

typedef struct graph_object {
  PyObject_HEAD pl_graph *graph; /* owned */
  PyObject *kept;                /* list: the maps that the graph borrows */
} graph_object;

static void graph_dealloc(PyObject *self) {
  PyTypeObject *type = Py_TYPE(self);
  pl_graph_destroy(((graph_object *)self)->graph);
  Py_XDECREF(((graph_object *)self)->kept);
  ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
  Py_DECREF(type);
}

const pl_graph *pl_py_graph_of(PyObject *object) {
  if (!pl_py_is(object, (void *)graph_dealloc)) {
    PyErr_SetString(PyExc_TypeError, "graphs must be perilune._core.Graph");
    return NULL;
  }
  return ((graph_object *)object)->graph;
}

/* --- parsing a description -------------------------------------------------------------------- */

/* Memory for the inputs and constants of one node. */
typedef struct node_room {
  pl_graph_input inputs[PL_NODE_SOCKETS];
  pl_constant constants[PL_NODE_CONSTANTS];
} node_room;

static const char *const sources[] = {"unset", "constant", "link", "parameter", NULL};

static int read_input(PyObject *item, pl_graph_input *out) {
  const char *source;
  Py_ssize_t index, output;
  if (!PyArg_ParseTuple(item, "snnfff", &source, &index, &output, &out->value[0], &out->value[1],
                        &out->value[2]))
    return -1;
  for (int k = 0; sources[k] != NULL; k++)
    if (strcmp(sources[k], source) == 0) {
      out->source = (pl_input_source)k;
      out->index = (size_t)index; /* negative values become too large and are rejected */
      out->output = (size_t)output;
      return 0;
    }
  PyErr_Format(PyExc_ValueError, "no source '%s' of an input", source);
  return -1;
}

/* Reads (number, numbers or None, map or None); adds referenced objects to `kept`. */
static int read_constant(PyObject *item, PyObject *kept, pl_constant *out) {
  PyObject *numbers, *map;
  const npy_intp any[1] = {-1};
  if (!PyArg_ParseTuple(item, "dOO", &out->number, &numbers, &map))
    return -1;
  if (map != Py_None &&
      ((out->texture = pl_py_map_of(map)) == NULL || PyList_Append(kept, map) < 0))
    return -1;
  if (numbers == Py_None)
    return 0;
  PyArrayObject *array = pl_py_array(numbers, "numbers", NPY_FLOAT, 1, any);
  if (array == NULL)
    return -1;
  out->numbers = PyArray_DATA(array);
  out->count = (size_t)PyArray_DIM(array, 0);
  const int failed = PyList_Append(kept, (PyObject *)array);
  Py_DECREF((PyObject *)array);
  return failed;
}

static int check_count(PyObject *list, size_t count, const char *what, const char *name) {
  if (PyTuple_Check(list) && (size_t)PyTuple_Size(list) == count)
    return 0;
  PyErr_Format(PyExc_ValueError, "%s: %s must be a tuple of %zu", name, what, count);
  return -1;
}

/* Reads (name, kind, inputs, constants). */
static int read_node(PyObject *item, PyObject *kept, node_room *room, pl_graph_node *out) {
  const char *kind;
  PyObject *inputs, *constants;
  if (!PyArg_ParseTuple(item, "ssOO", &out->name, &kind, &inputs, &constants))
    return -1;
  out->kind = pl_node_kind_find(kind);
  if (out->kind == NULL) {
    PyErr_Format(PyExc_ValueError, "%s: no kind of node '%s'; see perilune._core.NODES", out->name,
                 kind);
    return -1;
  }
  out->inputs = room->inputs;
  out->constants = room->constants;
  if (check_count(inputs, pl_node_input_count(out->kind), "inputs", out->name) < 0 ||
      check_count(constants, out->kind->constant_count, "constants", out->name) < 0)
    return -1;
  for (size_t k = 0; k < pl_node_input_count(out->kind); k++)
    if (read_input(PyTuple_GetItem(inputs, (Py_ssize_t)k), &room->inputs[k]) < 0)
      return -1;
  for (size_t k = 0; k < out->kind->constant_count; k++)
    if (read_constant(PyTuple_GetItem(constants, (Py_ssize_t)k), kept, &room->constants[k]) < 0)
      return -1;
  return 0;
}

static int make(graph_object *self, PyObject *nodes, pl_graph_description *d) {
  void *rows = NULL, *rooms = NULL;
  pl_status status = pl_alloc_or_fail(d->count, sizeof(pl_graph_node), "a graph", &rows);
  if (status != PL_OK)
    return pl_py_check(status, "graph");
  status = pl_alloc_or_fail(d->count, sizeof(node_room), "a graph", &rooms);
  int failed = status != PL_OK ? pl_py_check(status, "graph") : 0;
  for (size_t i = 0; failed == 0 && i < d->count; i++)
    failed = read_node(PyTuple_GetItem(nodes, (Py_ssize_t)i), self->kept, (node_room *)rooms + i,
                       (pl_graph_node *)rows + i);
  d->nodes = rows;
  if (failed == 0 && (status = pl_graph_create(d, &self->graph)) != PL_OK) {
    pl_py_raise(status);
    failed = -1;
  }
  pl_free(rooms);
  pl_free(rows);
  return failed;
}

static PyObject *graph_new(PyTypeObject *type, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"nodes", "surface", "parameters", "wrap", NULL};
  PyObject *nodes;
  Py_ssize_t surface, parameters;
  int wrap;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O!nnp:Graph", names, &PyTuple_Type, &nodes,
                                   &surface, &parameters, &wrap))
    return NULL;
  graph_object *self = (graph_object *)((allocfunc)PyType_GetSlot(type, Py_tp_alloc))(type, 0);
  if (self == NULL)
    return NULL;
  pl_graph_description d = {.count = (size_t)PyTuple_Size(nodes),
                            .surface = (size_t)surface,
                            .parameter_count = (size_t)parameters,
                            .wrap = wrap != 0};
  self->kept = PyList_New(0);
  if (self->kept == NULL || make(self, nodes, &d) < 0) {
    Py_DECREF(self);
    return NULL;
  }
  return (PyObject *)self;
}

/* --- evaluation ------------------------------------------------------------------------------- */

static PyObject *get_instructions(PyObject *self, void *closure) {
  (void)closure;
  return PyLong_FromSize_t(pl_graph_instruction_count(((graph_object *)self)->graph));
}

static PyObject *get_parameters(PyObject *self, void *closure) {
  (void)closure;
  return PyLong_FromSize_t(pl_graph_parameter_count(((graph_object *)self)->graph));
}

static PyObject *get_presence(PyObject *self, void *closure) {
  (void)closure;
  const pl_graph *graph = ((graph_object *)self)->graph;
  return PyLong_FromLong(pl_graph_absent(graph) ? PL_PRESENCE_NONE
                         : pl_graph_cuts(graph) ? PL_PRESENCE_PART
                                                : PL_PRESENCE_WHOLE);
}

static PyGetSetDef graph_getset[] = {
    {"instructions", get_instructions, NULL, "Nodes evaluated at each hit.", NULL},
    {"parameters", get_parameters, NULL, "Values that each frame gives.", NULL},
    {"presence", get_presence, NULL, "What its alpha leaves: 0 nothing, 1 a part, 2 all.", NULL},
    {NULL, NULL, NULL, NULL, NULL},
};

/* Writes the surface parameters as shading uses them: colour, metalness, alpha, emission. */
static void put_surface(const pl_surface *s, double *out) {
  const double row[8] = {s->color.x, s->color.y,    s->color.z,    s->metallic,
                         s->alpha,   s->emission.x, s->emission.y, s->emission.z};
  memcpy(out, row, sizeof row);
}

/* Evaluates the surface at a point in object axes, viewed along its normal. */
static pl_surface surface_at(const pl_graph *graph, pl_vec3f at, double radius,
                             const pl_value *parameters) {
  const pl_vec3f x = {1.0f, 0.0f, 0.0f}, y = {0.0f, 1.0f, 0.0f}, z = {0.0f, 0.0f, 1.0f};
  const pl_graph_point point = {.object = at,
                                .world = at,
                                .t = x,
                                .b = y,
                                .n = z,
                                .ng = z,
                                .view = z,
                                .radius = (float)radius,
                                .filter = PL_FILTER_FINEST,
                                .bumps = true,
                                .scale = 1.0f};
  pl_surface surface = {.t = x, .b = y, .n = z, .ng = z, .alpha = 1.0f};
  pl_graph_surface(graph, &point, parameters, &surface);
  return surface;
}

static PyObject *graph_evaluate(PyObject *object, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"points", "radius", "parameters", NULL};
  const pl_graph *graph = ((graph_object *)object)->graph;
  const npy_intp points[2] = {-1, 3}, shape[2] = {(npy_intp)pl_graph_parameter_count(graph), 4};
  PyObject *py_points, *py_parameters;
  double radius;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OdO:evaluate", names, &py_points, &radius,
                                   &py_parameters))
    return NULL;
  PyArrayObject *in = pl_py_array(py_points, "points", NPY_DOUBLE, 2, points);
  PyArrayObject *values =
      in != NULL ? pl_py_array(py_parameters, "parameters", NPY_FLOAT, 2, shape) : NULL;
  PyObject *out = NULL;
  if (values != NULL) {
    const npy_intp rows[2] = {PyArray_DIM(in, 0), 8};
    out = PyArray_SimpleNew(2, rows, NPY_DOUBLE);
  }
  for (npy_intp i = 0; out != NULL && i < PyArray_DIM(in, 0); i++) {
    const double *p = (const double *)PyArray_DATA(in) + 3 * i;
    const pl_vec3f at = pl_vec3f_make((float)p[0], (float)p[1], (float)p[2]);
    const pl_surface surface = surface_at(graph, at, radius, PyArray_DATA(values));
    put_surface(&surface, (double *)PyArray_DATA((PyArrayObject *)out) + 8 * i);
  }
  Py_XDECREF((PyObject *)in);
  Py_XDECREF((PyObject *)values);
  return out;
}

/* Monte Carlo estimate of the radiance reflected towards `wo` under a uniform sky of radiance 1, by
 * sampling the surface's BSDF. */
static void put_albedo(const pl_surface *s, pl_vec3f wo, uint32_t draws, double out[3]) {
  out[0] = out[1] = out[2] = 0.0;
  for (uint32_t i = 0; wo.z > 0.0f && i < draws; i++) {
    float u[2], pdf;
    pl_vec3f wi, weight;
    pl_sample_2d(i, 0, 0, u);
    if (!s->reflectance->sample(s, wo, u, &wi, &weight, &pdf))
      continue;
    out[0] += (double)weight.x / draws;
    out[1] += (double)weight.y / draws;
    out[2] += (double)weight.z / draws;
  }
}

static PyObject *graph_albedo(PyObject *object, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"towards", "draws", "parameters", NULL};
  const pl_graph *graph = ((graph_object *)object)->graph;
  const npy_intp directions[2] = {-1, 3};
  const npy_intp shape[2] = {(npy_intp)pl_graph_parameter_count(graph), 4};
  PyObject *py_towards, *py_parameters;
  unsigned int draws;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OIO:albedo", names, &py_towards, &draws,
                                   &py_parameters))
    return NULL;
  PyArrayObject *in = pl_py_array(py_towards, "towards", NPY_DOUBLE, 2, directions);
  PyArrayObject *values =
      in != NULL ? pl_py_array(py_parameters, "parameters", NPY_FLOAT, 2, shape) : NULL;
  PyObject *out = NULL;
  if (values != NULL) {
    const npy_intp rows[2] = {PyArray_DIM(in, 0), 3};
    out = PyArray_SimpleNew(2, rows, NPY_DOUBLE);
  }
  for (npy_intp i = 0; out != NULL && i < PyArray_DIM(in, 0); i++) {
    const double *w = (const double *)PyArray_DATA(in) + 3 * i;
    const pl_surface s = surface_at(graph, (pl_vec3f){0}, 0.0, PyArray_DATA(values));
    put_albedo(&s, pl_vec3f_make((float)w[0], (float)w[1], (float)w[2]), draws,
               (double *)PyArray_DATA((PyArrayObject *)out) + 3 * i);
  }
  Py_XDECREF((PyObject *)in);
  Py_XDECREF((PyObject *)values);
  return out;
}

/* --- classes of labels ------------------------------------------------------------------------ */

/* Rows of `ranges` (n, 2) with `ids` (n,). */
static int read_classes(PyArrayObject *ranges, PyArrayObject *ids, pl_graph_level *out) {
  void *memory;
  const double *row = PyArray_DATA(ranges);
  out->count = (size_t)PyArray_DIM(ranges, 0);
  if (pl_py_check(pl_alloc_or_fail(out->count, sizeof *out->classes, "classes", &memory),
                  "classes") < 0)
    return -1;
  out->classes = memory;
  for (size_t i = 0; i < out->count; i++)
    out->classes[i] = (pl_graph_class){.low = (float)row[2 * i],
                                       .high = (float)row[2 * i + 1],
                                       .id = ((const uint16_t *)PyArray_DATA(ids))[i]};
  return 0;
}

static PyObject *graph_add_level(PyObject *object, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"level", "value", "ranges", "ids", NULL};
  graph_object *self = (graph_object *)object;
  const npy_intp pairs[2] = {-1, 2};
  PyObject *value, *py_ranges, *py_ids;
  Py_ssize_t level;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "nOOO:add_level", names, &level, &value,
                                   &py_ranges, &py_ids))
    return NULL;
  pl_graph_level row = {.level = (size_t)level, .value = pl_py_graph_of(value)};
  if (row.value == NULL)
    return NULL;
  PyArrayObject *ranges = pl_py_array(py_ranges, "ranges", NPY_DOUBLE, 2, pairs);
  const npy_intp count[1] = {ranges != NULL ? PyArray_DIM(ranges, 0) : 0};
  PyArrayObject *ids = ranges != NULL ? pl_py_array(py_ids, "ids", NPY_UINT16, 1, count) : NULL;
  int failed = ids == NULL || read_classes(ranges, ids, &row) < 0 ||
               PyList_Append(self->kept, value) < 0 ||
               pl_py_check(pl_graph_add_level(self->graph, &row), "add_level") < 0;
  pl_free(row.classes);
  Py_XDECREF((PyObject *)ids);
  Py_XDECREF((PyObject *)ranges);
  if (failed)
    return NULL;
  Py_RETURN_NONE;
}

static PyMethodDef graph_methods[] = {
    {"add_level", (PyCFunction)(void (*)(void))graph_add_level, METH_VARARGS | METH_KEYWORDS,
     "Gives points classes at a level of labels, by the emission strength of another graph."},
    {"albedo", (PyCFunction)(void (*)(void))graph_albedo, METH_VARARGS | METH_KEYWORDS,
     "Light of an even sky that the surface sends towards directions."},
    {"evaluate", (PyCFunction)(void (*)(void))graph_evaluate, METH_VARARGS | METH_KEYWORDS,
     "The surface at points of the object's axes."},
    {NULL, NULL, 0, NULL},
};

static PyType_Slot graph_slots[] = {
    {Py_tp_doc, "Graph(nodes, surface, parameters, wrap)\n--\n\nA compiled material graph."},
    {Py_tp_new, (void *)graph_new},
    {Py_tp_dealloc, (void *)graph_dealloc},
    {Py_tp_getset, graph_getset},
    {Py_tp_methods, graph_methods},
    {0, NULL},
};

PyType_Spec pl_py_graph_spec = {"perilune._core.Graph", sizeof(graph_object), 0, Py_TPFLAGS_DEFAULT,
                                graph_slots};

/* --- table of node kinds ---------------------------------------------------------------------- */

static PyObject *socket_row(const pl_socket *socket) {
  static const char *const types[] = {"scalar", "vector", "color"};
  return Py_BuildValue("{s:s,s:s,s:(fff),s:s}", "name", socket->name, "type", types[socket->type],
                       "default", (double)socket->fallback[0], (double)socket->fallback[1],
                       (double)socket->fallback[2], "doc", socket->doc);
}

typedef const pl_socket *(*socket_fn)(const pl_node_kind *kind, size_t k);

static const pl_socket *output_of(const pl_node_kind *kind, size_t k) { return &kind->outputs[k]; }

static PyObject *sockets_of(const pl_node_kind *kind, socket_fn socket, size_t count) {
  PyObject *tuple = PyTuple_New((Py_ssize_t)count);
  for (size_t i = 0; tuple != NULL && i < count; i++) {
    PyObject *row = socket_row(socket(kind, i));
    if (row == NULL)
      Py_CLEAR(tuple);
    else
      PyTuple_SetItem(tuple, (Py_ssize_t)i, row);
  }
  return tuple;
}

static PyObject *choices_of(const pl_constant_row *row) {
  PyObject *list = PyList_New(0);
  for (size_t i = 0; list != NULL && row->choices != NULL && row->choices[i] != NULL; i++) {
    PyObject *name = PyUnicode_FromString(row->choices[i]);
    if (name == NULL || PyList_Append(list, name) < 0)
      Py_CLEAR(list);
    Py_XDECREF(name);
  }
  PyObject *tuple = list != NULL ? PyList_AsTuple(list) : NULL;
  Py_XDECREF(list);
  return tuple;
}

static PyObject *constants_of(const pl_node_kind *kind) {
  static const char *const types[] = {"number", "choice", "numbers", "image"};
  PyObject *tuple = PyTuple_New((Py_ssize_t)kind->constant_count);
  for (size_t i = 0; tuple != NULL && i < kind->constant_count; i++) {
    const pl_constant_row *row = &kind->constants[i];
    PyObject *choices = choices_of(row);
    PyObject *item = choices == NULL
                         ? NULL
                         : Py_BuildValue("{s:s,s:s,s:d,s:d,s:d,s:N,s:n,s:s}", "name", row->name,
                                         "type", types[row->type], "default", row->fallback, "low",
                                         row->low, "high", row->high, "choices", choices, "columns",
                                         (Py_ssize_t)row->columns, "doc", row->doc);
    if (item == NULL)
      Py_CLEAR(tuple);
    else
      PyTuple_SetItem(tuple, (Py_ssize_t)i, item);
  }
  return tuple;
}

PyObject *pl_py_nodes(void) {
  PyObject *dict = PyDict_New();
  for (size_t i = 0; dict != NULL && i < pl_node_kind_count; i++) {
    const pl_node_kind *kind = pl_node_kinds[i];
    PyObject *inputs = sockets_of(kind, pl_node_input, pl_node_input_count(kind));
    PyObject *outputs = inputs != NULL ? sockets_of(kind, output_of, kind->output_count) : NULL;
    PyObject *constants = outputs != NULL ? constants_of(kind) : NULL;
    PyObject *row =
        constants == NULL
            ? NULL
            : Py_BuildValue("{s:s,s:O,s:O,s:O,s:O,s:O}", "doc",
                            kind->reflectance != NULL ? kind->reflectance->doc : kind->doc,
                            "inputs", inputs, "outputs", outputs, "constants", constants, "surface",
                            kind->evaluate == NULL ? Py_True : Py_False, "own",
                            kind->reads_own ? Py_True : Py_False);
    if (row == NULL || PyDict_SetItemString(dict, kind->name, row) < 0)
      Py_CLEAR(dict);
    Py_XDECREF(inputs);
    Py_XDECREF(outputs);
    Py_XDECREF(constants);
    Py_XDECREF(row);
  }
  return dict;
}
