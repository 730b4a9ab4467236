/* Ray sources: their table, and sources from mappings. */
#include "pyext/py_ray_source.h"

#include <string.h>

#include "pyext/py_read.h"
#include "pyext/py_types.h"

static const char *const WHERE = "ray source";

static int parse_kind(PyObject *spec, const pl_ray_source_kind **out) {
  const char *names[16];
  for (size_t i = 0; i < pl_ray_source_kind_count; i++)
    names[i] = pl_ray_source_kinds[i]->name;
  const int at = pl_py_member_choice(spec, "kind", WHERE, names, (int)pl_ray_source_kind_count);
  *out = at >= 0 ? pl_ray_source_kinds[at] : NULL;
  return at >= 0 ? 0 : -1;
}

static int parse_list(PyObject *spec, pl_py_ray_source *out) {
  const pl_ray_source_kind *kind = out->core.kind;
  const npy_intp shape[2] = {-1, (npy_intp)kind->list_row};
  if (kind->list == NULL)
    return 0;
  out->list =
      (PyObject *)pl_py_member_array(spec, kind->list, WHERE, kind->list_row > 1 ? 2 : 1, shape);
  if (out->list == NULL)
    return -1;
  out->core.list = PyArray_DATA((PyArrayObject *)out->list);
  out->core.list_count = (size_t)PyArray_DIM((PyArrayObject *)out->list, 0);
  return 0;
}

int pl_py_ray_source_parse(PyObject *spec, pl_py_ray_source *out) {
  size_t sub_rays;
  *out = (pl_py_ray_source){.list = NULL};
  if (parse_kind(spec, &out->core.kind) < 0 || parse_list(spec, out) < 0 ||
      pl_py_member_size(spec, "sub_rays", WHERE, &sub_rays) < 0 ||
      pl_py_member_double(spec, "divergence_rad", WHERE, &out->core.divergence_rad) < 0 ||
      pl_py_member_double(spec, "aperture_m", WHERE, &out->core.aperture_m) < 0)
    return -1;
  for (size_t i = 0; i < out->core.kind->value_count; i++)
    if (pl_py_member_double(spec, out->core.kind->values[i].name, WHERE, &out->core.value[i]) < 0)
      return -1;
  out->core.sub_rays = sub_rays <= PL_SUB_RAYS_MAX ? (int)sub_rays : PL_SUB_RAYS_MAX + 1;
  const pl_status status = pl_ray_source_check(&out->core);
  if (status == PL_OK)
    return 0;
  pl_py_raise(status);
  return -1;
}

void pl_py_ray_source_clear(pl_py_ray_source *source) { Py_CLEAR(source->list); }

static PyObject *value_entries(const pl_ray_source_kind *kind) {
  PyObject *out = PyTuple_New((Py_ssize_t)kind->value_count);
  for (size_t i = 0; out != NULL && i < kind->value_count; i++) {
    const pl_ray_value *value = &kind->values[i];
    PyObject *entry =
        Py_BuildValue("{s:s,s:s,s:d,s:d,s:O}", "name", value->name, "doc", value->doc, "low",
                      value->low, "high", value->high, "whole", value->whole ? Py_True : Py_False);
    if (entry == NULL)
      Py_CLEAR(out);
    else
      PyTuple_SetItem(out, (Py_ssize_t)i, entry);
  }
  return out;
}

PyObject *pl_py_ray_sources(void) {
  PyObject *out = PyTuple_New((Py_ssize_t)pl_ray_source_kind_count);
  for (size_t i = 0; out != NULL && i < pl_ray_source_kind_count; i++) {
    const pl_ray_source_kind *kind = pl_ray_source_kinds[i];
    PyObject *values = value_entries(kind);
    PyObject *entry = values != NULL
                          ? Py_BuildValue("{s:s,s:s,s:z,s:N}", "name", kind->name, "doc", kind->doc,
                                          "list", kind->list, "values", values)
                          : NULL;
    if (entry == NULL)
      Py_CLEAR(out);
    else
      PyTuple_SetItem(out, (Py_ssize_t)i, entry);
  }
  return out;
}

/* Reads a source that needs no frame. */
static int parse_alone(PyObject *spec, pl_py_ray_source *out) {
  if (pl_py_ray_source_parse(spec, out) < 0)
    return -1;
  if (!out->core.kind->camera)
    return 0;
  PyErr_Format(PyExc_ValueError, "%s: '%s' needs the camera of a frame", WHERE,
               out->core.kind->name);
  return -1;
}

PyObject *pl_py_source_extent(PyObject *module, PyObject *spec) {
  pl_py_ray_source source;
  PyObject *out = NULL;
  (void)module;
  if (parse_alone(spec, &source) == 0)
    out = Py_BuildValue("(nd)", (Py_ssize_t)source.core.kind->count(&source.core),
                        source.core.kind->duration_s(&source.core));
  pl_py_ray_source_clear(&source);
  return out;
}

PyObject *pl_py_source_rays(PyObject *module, PyObject *spec) {
  pl_py_ray_source source;
  PyObject *out = NULL;
  (void)module;
  if (parse_alone(spec, &source) == 0) {
    const size_t count = source.core.kind->count(&source.core);
    const npy_intp shape[3] = {(npy_intp)count, source.core.sub_rays, 8};
    out = PyArray_SimpleNew(3, shape, NPY_DOUBLE);
    double *row = out != NULL ? PyArray_DATA((PyArrayObject *)out) : NULL;
    for (size_t i = 0; row != NULL && i < count; i++)
      for (int sub = 0; sub < source.core.sub_rays; sub++, row += 8) {
        pl_sensor_ray ray;
        pl_ray_source_ray(&source.core, i, sub, &ray);
        const double values[8] = {ray.origin.x,    ray.origin.y,    ray.origin.z, ray.direction.x,
                                  ray.direction.y, ray.direction.z, ray.time_s,   ray.line};
        memcpy(row, values, sizeof values);
      }
  }
  pl_py_ray_source_clear(&source);
  return out;
}
