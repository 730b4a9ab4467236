/* The module's types, and safe access to what they hold. */
#ifndef PL_PYEXT_PY_TYPES_H
#define PL_PYEXT_PY_TYPES_H

#include "pyext/py_common.h"

#include "geom/model.h"
#include "scene/scene.h"

extern PyType_Spec pl_py_model_spec, pl_py_map_spec, pl_py_scene_spec, pl_py_renderer_spec,
    pl_py_articulation_spec, pl_py_graph_spec, pl_py_grid_spec, pl_py_stars_spec, pl_py_air_spec,
    pl_py_rings_spec;

/* Borrowed contents; NULL with TypeError when the object is of another type. */
const pl_model *pl_py_model_of(PyObject *object);
const pl_texture *pl_py_map_of(PyObject *object);
const pl_graph *pl_py_graph_of(PyObject *object);
const pl_grid *pl_py_grid_of(PyObject *object);
const pl_air *pl_py_air_of(PyObject *object);
const pl_rings *pl_py_rings_of(PyObject *object);
/* NODES, as documented in the stub. A new reference. */
PyObject *pl_py_nodes(void);
/* The function band_gather, as documented in the stub. */
PyObject *pl_py_band_gather(PyObject *module, PyObject *args);
/* The function gltf_graphs, as documented in the stub. */
PyObject *pl_py_gltf_graphs(PyObject *module, PyObject *path);
/* The function sunlight, as documented in the stub. */
PyObject *pl_py_sunlight(PyObject *module, PyObject *args, PyObject *kwargs);
/* The function cloud_cover, as documented in the stub. */
PyObject *pl_py_cloud_cover(PyObject *module, PyObject *args);
/* Marks the scene as in use, so that nothing is added any more. */
const pl_scene *pl_py_scene_freeze(PyObject *object);
/* While a frame of the scene is rendered (change +1 before, -1 after) its materials stay. */
void pl_py_scene_hold(PyObject *scene, int change);

/* Whether `object` is of the type that has this tp_dealloc: our types cannot be subclassed, so the
 * function identifies them without module state (the limited API of 3.11 has no way from an
 * argument to the module). */
int pl_py_is(PyObject *object, void *dealloc);

/* `array` as C-contiguous values of `type` with exactly these dimensions (-1: any), or NULL with
 * ValueError naming `what`. A new reference. */
PyArrayObject *pl_py_array(PyObject *object, const char *what, int type, int nd,
                           const npy_intp *shape);

#endif
