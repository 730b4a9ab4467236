/* What lies on a terrain, from Python: tracks of wheels and textures. Functions return -1 with an
 * exception. */
#ifndef PL_PYEXT_PY_LAYERS_H
#define PL_PYEXT_PY_LAYERS_H

#include "pyext/py_common.h"
#include "terrain/terrain.h"

enum { PL_PY_TRACKS = 64 };

/* Reads a sequence of tracks; None: none. The arrays, of their points, are the caller's. */
int pl_py_tracks_of(PyObject *given, PyArrayObject *arrays[PL_PY_TRACKS], pl_wheel_track *out,
                    size_t *count);
/* Reads a sequence of textures; None: none. The list `kept` gets their rasters. */
int pl_py_textures_of(PyObject *given, PyObject *kept, pl_ground_texture out[PL_GROUND_TEXTURES],
                      size_t *count);

#endif
