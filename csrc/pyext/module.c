/* The module _core: its types, tables and small functions. */
#define PL_IMPORT_NUMPY
#include "pyext/py_common.h"

#include <string.h>

#include "base/memory.h"
#include "plan/cost.h"
#include "frame/effects.h"
#include "io/simplify.h"
#include "orbit/propagator.h"
#include "orbit/turn.h"
#include "pyext/py_camera.h"
#include "pyext/py_image.h"
#include "pyext/py_orbit.h"
#include "pyext/py_propagator.h"
#include "pyext/py_ray_source.h"
#include "pyext/py_request.h"
#include "pyext/py_tree.h"
#include "pyext/py_types.h"
#include "shade/reflectance.h"
#include "trace/tracer.h"

static PyObject *simplify(PyObject *module, PyObject *args) {
  const npy_intp rows[2] = {-1, 3};
  PyObject *py_positions, *py_indices;
  Py_ssize_t target;
  double error;
  (void)module;
  if (!PyArg_ParseTuple(args, "OOnd:simplify", &py_positions, &py_indices, &target, &error))
    return NULL;
  if (target < 0)
    return PyErr_Format(PyExc_ValueError, "simplify: target = %zd; must be 0 or more", target);
  PyArrayObject *p = pl_py_array(py_positions, "positions", NPY_FLOAT, 2, rows);
  PyArrayObject *i = p != NULL ? pl_py_array(py_indices, "indices", NPY_UINT32, 2, rows) : NULL;
  npy_intp shape[2] = {i != NULL ? PyArray_DIM(i, 0) : 0, 3};
  PyObject *out = i != NULL ? PyArray_SimpleNew(2, shape, NPY_UINT32) : NULL;
  pl_status status = PL_OK;
  size_t count = 0;
  if (out != NULL) {
    Py_BEGIN_ALLOW_THREADS status =
        pl_simplify(PyArray_DATA(p), (size_t)PyArray_DIM(p, 0), PyArray_DATA(i), (size_t)shape[0],
                    (size_t)target, (float)error, PyArray_DATA((PyArrayObject *)out), &count);
    Py_END_ALLOW_THREADS
  }
  Py_XDECREF((PyObject *)p);
  Py_XDECREF((PyObject *)i);
  PyObject *kept =
      out != NULL && status == PL_OK ? PySequence_GetSlice(out, 0, (Py_ssize_t)count) : NULL;
  Py_XDECREF(out);
  return status == PL_OK ? kept : pl_py_raise(status);
}

static const char *instruction_set(void) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f"))
    return "avx512";
  if (__builtin_cpu_supports("avx2"))
    return "avx2";
  return "sse2";
#elif defined(__aarch64__)
  return "neon";
#else
  return "generic";
#endif
}

static PyObject *version(PyObject *module, PyObject *unused) {
  (void)module;
  (void)unused;
  return Py_BuildValue("{s:s,s:s,s:s}", "embree", pl_tracer_version(), "compiler", __VERSION__,
                       "instruction_set", instruction_set());
}

static PyObject *allocations(PyObject *module, PyObject *unused) {
  (void)module;
  (void)unused;
  return PyLong_FromUnsignedLongLong(pl_memory_allocations());
}

static PyMethodDef functions[] = {
    {"band_gather", pl_py_band_gather, METH_VARARGS, "What a band gathers of sunlight."},
    {"allocations", allocations, METH_NOARGS, "Allocations made by the core so far."},
    {"clods", pl_py_clods, METH_O, "Heights of clods on a sample of ground."},
    {"cloud_cover", pl_py_cloud_cover, METH_VARARGS, "Parts of footprints that clouds cover."},
    {"draws", pl_py_draws, METH_VARARGS, "Standard numbers of many streams of NumPy's Philox."},
    {"deflate", pl_py_deflate, METH_VARARGS, "Bytes by deflate."},
    {"exr_encode", pl_py_exr_encode, METH_VARARGS, "An OpenEXR file of named planes, as bytes."},
    {"exr_decode", pl_py_exr_decode, METH_VARARGS, "The planes of an OpenEXR file, by name."},
    {"gltf_graphs", pl_py_gltf_graphs, METH_O, "Graphs in the extras of a file's materials."},
    {"mottling", pl_py_mottling, METH_O, "Fractions of bright ground on a sample."},
    {"png_encode", (PyCFunction)(void (*)(void))pl_py_png_encode, METH_VARARGS | METH_KEYWORDS,
     "The bytes of an image array as PNG."},
    {"png_grey", pl_py_png_grey, METH_VARARGS, "Numbers of a grey PNG of any depth, as 16 bits."},
    {"png_write", (PyCFunction)(void (*)(void))pl_py_png_write, METH_VARARGS | METH_KEYWORDS,
     "Writes an image array as PNG, atomically."},
    {"project", pl_py_project, METH_VARARGS, "Pixels of points in camera axes."},
    {"unproject", pl_py_unproject, METH_VARARGS, "Directions of pixels in camera axes."},
    {"rim_images", pl_py_rim_images, METH_VARARGS, "Images of the rims of craters."},
    {"simplify", simplify, METH_VARARGS, "Indices of a mesh with fewer triangles."},
    {"source_extent", pl_py_source_extent, METH_O,
     "Number of beams of a ray source, and its time."},
    {"source_rays", pl_py_source_rays, METH_O, "The rays of a ray source."},
    {"sunlight", (PyCFunction)(void (*)(void))pl_py_sunlight, METH_VARARGS | METH_KEYWORDS,
     "The fraction of the sun's light that bodies let through."},
    {"version", version, METH_NOARGS, "Versions of what the core was built with."},
    {NULL, NULL, 0, NULL},
};

/* Adds a new reference (or NULL after an error) to the module. */
static int add(PyObject *module, const char *name, PyObject *value) {
  const int failed = value == NULL ? -1 : PyModule_AddObjectRef(module, name, value);
  Py_XDECREF(value);
  return failed;
}

static PyObject *named_rows(size_t count, const char *(*name)(size_t), const char *(*doc)(size_t)) {
  PyObject *rows = PyTuple_New((Py_ssize_t)count);
  for (size_t i = 0; rows != NULL && i < count; i++) {
    PyObject *row = Py_BuildValue("{s:s,s:s}", "name", name(i), "doc", doc(i));
    if (row == NULL)
      Py_CLEAR(rows);
    else
      PyTuple_SetItem(rows, (Py_ssize_t)i, row);
  }
  return rows;
}

static PyObject *costs(void) {
  PyObject *rows = PyTuple_New(PL_WORK_COUNT);
  for (int i = 0; rows != NULL && i < PL_WORK_COUNT; i++) {
    PyObject *row = Py_BuildValue("{s:s,s:s,s:d}", "name", pl_work_name((pl_work)i), "doc",
                                  pl_work_doc((pl_work)i), "ns", pl_cost_ns((pl_work)i));
    if (row == NULL)
      Py_CLEAR(rows);
    else
      PyTuple_SetItem(rows, i, row);
  }
  return rows;
}

static const char *effect_name(size_t i) { return pl_effects[i]->name; }
static const char *effect_doc(size_t i) { return pl_effects[i]->doc; }
static const char *reflectance_name(size_t i) { return pl_reflectances[i]->name; }
static const char *reflectance_doc(size_t i) { return pl_reflectances[i]->doc; }

static const char *propagator_name(size_t i) {
  size_t count;
  return pl_propagator_kinds(&count)[i]->name;
}
static const char *propagator_doc(size_t i) {
  size_t count;
  return pl_propagator_kinds(&count)[i]->doc;
}
static const char *turn_name(size_t i) {
  size_t count;
  return pl_turn_kinds(&count)[i].name;
}
static const char *turn_doc(size_t i) {
  size_t count;
  return pl_turn_kinds(&count)[i].doc;
}

static const char *crater_law_name(size_t i) { return pl_crater_laws[i].name; }
static const char *crater_law_doc(size_t i) { return pl_crater_laws[i].doc; }

static const char *rock_law_name(size_t i) { return pl_rock_laws[i].name; }
static const char *rock_law_doc(size_t i) { return pl_rock_laws[i].doc; }
static const char *rock_family_name(size_t i) { return pl_rock_families[i].name; }
static const char *rock_family_doc(size_t i) { return pl_rock_families[i].doc; }

static int execute(PyObject *module) {
  PyType_Spec *const specs[] = {
      &pl_py_model_spec,      &pl_py_map_spec,     &pl_py_scene_spec,        &pl_py_renderer_spec,
      &pl_py_propagator_spec, &pl_py_tree_spec,    &pl_py_articulation_spec, &pl_py_graph_spec,
      &pl_py_grid_spec,       &pl_py_stars_spec,   &pl_py_air_spec,          &pl_py_rings_spec,
      &pl_py_raster_spec,     &pl_py_terrain_spec, &pl_py_craters_spec,      &pl_py_rocks_spec,
      &pl_py_rock_scan_spec};
  if (PyArray_ImportNumPyAPI() < 0)
    return -1;
  for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++)
    if (add(module, strrchr(specs[i]->name, '.') + 1,
            PyType_FromModuleAndSpec(module, specs[i], NULL)) < 0)
      return -1;
  if (add(module, "CHANNELS", pl_py_channels()) < 0 ||
      add(module, "OBJECT_LABEL", pl_py_object_label()) < 0 ||
      add(module, "KEYPOINT_LABEL", pl_py_keypoint_label()) < 0 ||
      add(module, "EFFECTS", named_rows(pl_effect_count, effect_name, effect_doc)) < 0 ||
      add(module, "REFLECTANCES",
          named_rows(pl_reflectance_count, reflectance_name, reflectance_doc)) < 0 ||
      PyModule_AddFunctions(module, pl_py_orbit_methods) < 0)
    return -1;
  size_t propagators, turns;
  pl_propagator_kinds(&propagators);
  pl_turn_kinds(&turns);
  if (add(module, "PROPAGATORS", named_rows(propagators, propagator_name, propagator_doc)) < 0 ||
      add(module, "TURNS", named_rows(turns, turn_name, turn_doc)) < 0 ||
      add(module, "FORCES", pl_py_forces()) < 0 || add(module, "NODES", pl_py_nodes()) < 0 ||
      add(module, "LENSES", pl_py_lenses()) < 0 ||
      add(module, "CRATER", pl_py_crater_record()) < 0 ||
      add(module, "RIM_IMAGE", pl_py_rim_record()) < 0 ||
      add(module, "CRATER_LAWS", named_rows(PL_CRATER_LAWS, crater_law_name, crater_law_doc)) < 0 ||
      add(module, "RAY_SOURCES", pl_py_ray_sources()) < 0 || add(module, "COSTS", costs()) < 0 ||
      add(module, "EVENT", pl_py_event()) < 0 ||
      add(module, "LIDAR_RETURN", pl_py_lidar_return()) < 0 ||
      add(module, "TIME_OF_FLIGHT_PIXEL", pl_py_time_of_flight_pixel()) < 0 ||
      add(module, "ROCK", pl_py_rock_record()) < 0 ||
      add(module, "ROCK_LAWS", named_rows(PL_ROCK_LAWS, rock_law_name, rock_law_doc)) < 0 ||
      add(module, "ROCK_FAMILIES",
          named_rows(PL_ROCK_FAMILIES, rock_family_name, rock_family_doc)) < 0)
    return -1;
  return pl_py_orbit_add_constants(module);
}

static PyModuleDef_Slot slots[] = {
    {Py_mod_exec, (void *)execute},
    {0, NULL},
};

static PyModuleDef definition = {
    PyModuleDef_HEAD_INIT,  .m_name = "perilune._core", .m_doc = "The C core of Perilune.",
    .m_methods = functions, .m_slots = slots,
};

PyMODINIT_FUNC PyInit__core(void) { return PyModuleDef_Init(&definition); }
