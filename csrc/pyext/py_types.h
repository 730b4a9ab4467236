/* The module's types, and safe access to their contents. */
#ifndef PL_PYEXT_PY_TYPES_H
#define PL_PYEXT_PY_TYPES_H

#include "pyext/py_common.h"

#include "geom/model.h"
#include "scene/scene.h"
#include "terrain/crater_field.h"
#include "terrain/rock_field.h"
#include "terrain/raster.h"
#include "terrain/terrain.h"

extern PyType_Spec pl_py_model_spec, pl_py_map_spec, pl_py_scene_spec, pl_py_renderer_spec,
    pl_py_articulation_spec, pl_py_graph_spec, pl_py_grid_spec, pl_py_stars_spec, pl_py_air_spec,
    pl_py_rings_spec, pl_py_raster_spec, pl_py_terrain_spec, pl_py_craters_spec, pl_py_rocks_spec,
    pl_py_rock_scan_spec;

/* Return borrowed contents; NULL with TypeError for an object of another type. */
const pl_model *pl_py_model_of(PyObject *object);
const pl_texture *pl_py_map_of(PyObject *object);
const pl_graph *pl_py_graph_of(PyObject *object);
const pl_grid *pl_py_grid_of(PyObject *object);
const pl_air *pl_py_air_of(PyObject *object);
const pl_rings *pl_py_rings_of(PyObject *object);
const pl_terrain *pl_py_terrain_of(PyObject *object);
const pl_crater_field *pl_py_craters_of(PyObject *object);
/* Arguments of the methods that list craters, and their result: a new array, or NULL with an
 * exception. Frees the craters. */
typedef struct pl_py_crater_region {
  pl_vec3 direction;
  double radius_m, min_m, max_m;
} pl_py_crater_region;
int pl_py_crater_region_of(PyObject *args, PyObject *kwargs, pl_py_crater_region *out);
PyObject *pl_py_crater_list(pl_status status, pl_crater *craters, size_t count);
/* The function rim_images, as documented in the stub, and the description of its records. */
PyObject *pl_py_rim_images(PyObject *module, PyObject *args);
PyObject *pl_py_rim_record(void);
/* Returns CRATER, the description of CraterField.list's records, as documented in the stub. */
PyObject *pl_py_crater_record(void);
const pl_rock_scan *pl_py_rock_scan_of(PyObject *object);
const pl_rock_field *pl_py_rocks_of(PyObject *object);
/* Returns the records of the rocks of ids on a terrain. */
PyObject *pl_py_rocks_find(const pl_terrain *terrain, PyObject *ids);
/* Returns these records and points of the rocks over the ground, of (ids, eye, pixel_rad). */
PyObject *pl_py_rock_surfaces(const pl_terrain *terrain, PyObject *args);
/* Returns ROCK, the description of RockField.list's records, as documented in the stub. */
PyObject *pl_py_rock_record(void);
const pl_raster *pl_py_raster_of(PyObject *object);
/* Returns NODES, as documented in the stub; a new reference. */
PyObject *pl_py_nodes(void);
/* The function band_gather, as documented in the stub. */
PyObject *pl_py_band_gather(PyObject *module, PyObject *args);
/* The function draws, as documented in the stub. */
PyObject *pl_py_draws(PyObject *module, PyObject *args);
/* The function gltf_graphs, as documented in the stub. */
PyObject *pl_py_gltf_graphs(PyObject *module, PyObject *path);
/* The function sunlight, as documented in the stub. */
PyObject *pl_py_sunlight(PyObject *module, PyObject *args, PyObject *kwargs);
/* The functions clods and mottling, as documented in the stub. */
PyObject *pl_py_clods(PyObject *module, PyObject *given);
PyObject *pl_py_mottling(PyObject *module, PyObject *given);
/* The function cloud_cover, as documented in the stub. */
PyObject *pl_py_cloud_cover(PyObject *module, PyObject *args);
/* Marks the scene as in use: nothing can be added from then on. */
const pl_scene *pl_py_scene_freeze(PyObject *object);
/* Between hold and release the scene's materials cannot change and nothing can be added. Returns -1
 * with ValueError while another thread, or the code of an argument, is changing it. */
int pl_py_scene_hold(PyObject *scene);
void pl_py_scene_release(PyObject *scene);

/* Returns true if `object` is of the type with this tp_dealloc. Our types cannot be subclassed, so
 * the function identifies them without module state (in the limited API of 3.11 there is no way
 * from an argument to the module). */
int pl_py_is(PyObject *object, void *dealloc);

/* Returns `object` as C-contiguous values of `type` (a new reference), or NULL with an exception.
 * It is always a private copy: code of other arguments, and other threads, could resize or reshape
 * the original between our checks and our use of it. */
PyArrayObject *pl_py_own_array(PyObject *object, int type);
/* As pl_py_own_array, with exactly these dimensions (-1: any); a ValueError names `what`. */
PyArrayObject *pl_py_array(PyObject *object, const char *what, int type, int nd,
                           const npy_intp *shape);

/* Returns a copy of `count` packed structs as an array of records, or NULL with an exception.
 * Steals the description, which may be NULL with an exception. */
PyObject *pl_py_records(PyObject *description, const void *records, size_t count, size_t size);

/* For large arrays that are not copied: appends `array` to the list `kept`, and prevents its memory
 * from moving while `kept` exists. */
int pl_py_keep_memory(PyObject *kept, PyObject *array);

#endif
