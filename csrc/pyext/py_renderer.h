/* The type Renderer, for the files that add methods to it. */
#ifndef PL_PYEXT_PY_RENDERER_H
#define PL_PYEXT_PY_RENDERER_H

#include "pyext/py_request.h"

#include <sys/types.h>

typedef struct pl_py_renderer {
  PyObject_HEAD PyObject *scene; /* Scene */
  const pl_scene *core;          /* content of `scene` */
  pl_renderer *renderer;         /* owned */
  pl_py_states states;
  pl_py_other others[PL_FLOW_FRAMES];
  pid_t pid; /* process that created it: Embree and its memory do not work in a forked child */
  /* guarded by the GIL; set from before a request is parsed until after its result is built */
  int busy;
} pl_py_renderer;

/* Acquires the renderer and its scene. Called before any part of the request is read: values,
 * arrays and mappings may run arbitrary code when they are accessed, including frames of this
 * renderer. Returns -1 with an exception. */
int pl_py_renderer_begin(pl_py_renderer *self);
void pl_py_renderer_end(pl_py_renderer *self);

/* Runs `work` without the GIL; ctrl-C cancels it through request->cancel. */
pl_status pl_py_renderer_run(pl_frame_request *request, pl_status (*work)(void *), void *context);

/* The methods of sensors that trace rays of their own, as documented in the stub. */
PyObject *pl_py_renderer_trace(PyObject *self, PyObject *args, PyObject *kwargs);
PyObject *pl_py_renderer_lidar(PyObject *self, PyObject *args, PyObject *kwargs);
PyObject *pl_py_renderer_time_of_flight(PyObject *self, PyObject *args, PyObject *kwargs);
PyObject *pl_py_renderer_measure_scan(PyObject *self, PyObject *args);
PyObject *pl_py_renderer_events(PyObject *self, PyObject *args, PyObject *kwargs);

#endif
