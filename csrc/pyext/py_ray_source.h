/* Ray sources for Python. */
#ifndef PL_PYEXT_PY_RAY_SOURCE_H
#define PL_PYEXT_PY_RAY_SOURCE_H

#include "pyext/py_common.h"

#include "scene/ray_source.h"

/* A source that was read, and the array that its list is in. */
typedef struct pl_py_ray_source {
  pl_ray_source core;
  PyObject *list; /* owned; NULL for none */
} pl_py_ray_source;

/* Reads a source from a mapping, as documented in the stub; returns -1 with an exception. Call
 * pl_py_ray_source_clear in any case. */
int pl_py_ray_source_parse(PyObject *spec, pl_py_ray_source *out);
void pl_py_ray_source_clear(pl_py_ray_source *source);

/* RAY_SOURCES, and the functions source_extent and source_rays, as documented in the stub. */
PyObject *pl_py_ray_sources(void);
PyObject *pl_py_source_extent(PyObject *module, PyObject *spec);
PyObject *pl_py_source_rays(PyObject *module, PyObject *spec);

/* EVENT, LIDAR_RETURN and TIME_OF_FLIGHT_PIXEL, as documented in the stub. */
PyObject *pl_py_event(void);
PyObject *pl_py_lidar_return(void);
PyObject *pl_py_time_of_flight_pixel(void);

#endif
