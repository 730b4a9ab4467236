/* The type Renderer: renders frames of one scene. Releases the GIL, and handles ctrl-C. */
#include "pyext/py_renderer.h"
#include "pyext/py_sky.h"
#include "pyext/py_types.h"

#include <time.h>
#include <unistd.h>

#include "base/memory.h"
#include "frame/measure.h"

static void free_states(pl_py_states *states) {
  pl_free(states->objects);
  pl_free(states->bodies);
  pl_free(states->movers);
  pl_free(states->parameters);
  pl_free(states->keys.numbers);
  pl_free(states->volume_parameters);
  pl_free(states->keypoints);
  pl_free(states->groups);
}

static void renderer_dealloc(PyObject *object) {
  pl_py_renderer *self = (pl_py_renderer *)object;
  PyTypeObject *type = Py_TYPE(object);
  /* a forked child has only an unusable copy of the device, which is not freed */
  if (self->pid == getpid())
    pl_renderer_destroy(self->renderer);
  free_states(&self->states);
  for (int i = 0; i < PL_FLOW_FRAMES; i++) {
    free_states(&self->others[i].states);
    pl_free(self->others[i].changed);
  }
  Py_XDECREF(self->scene);
  ((freefunc)PyType_GetSlot(type, Py_tp_free))(object);
  Py_DECREF(type);
}

static pl_status take_states(const pl_scene *scene, pl_py_states *out) {
  void *objects, *bodies, *movers;
  PL_TRY(pl_alloc_or_fail(scene->craft_count, sizeof(pl_object_state), "poses", &objects));
  out->objects = objects;
  PL_TRY(pl_alloc_or_fail(scene->body_count, sizeof(pl_body_state), "poses", &bodies));
  out->bodies = bodies;
  for (size_t i = 0; i < scene->craft_count; i++)
    out->mover_count += pl_object_mover_count(&scene->objects[i]);
  PL_TRY(pl_alloc_or_fail(out->mover_count, sizeof(pl_affine), "motions", &movers));
  out->movers = movers;
  return PL_OK;
}

static pl_status open_renderer(pl_py_renderer *self) {
  PL_TRY(take_states(self->core, &self->states));
  for (int i = 0; i < PL_FLOW_FRAMES; i++) {
    void *changed;
    PL_TRY(take_states(self->core, &self->others[i].states));
    PL_TRY(pl_alloc_or_fail(self->core->body_count, sizeof(bool), "bodies", &changed));
    self->others[i].changed = changed;
  }
  return pl_renderer_create(self->core, &self->renderer);
}

static PyObject *renderer_new(PyTypeObject *type, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"scene", NULL};
  PyObject *scene;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "O:Renderer", names, &scene))
    return NULL;
  const pl_scene *core = pl_py_scene_freeze(scene);
  if (core == NULL)
    return NULL;
  pl_py_renderer *self = (pl_py_renderer *)((allocfunc)PyType_GetSlot(type, Py_tp_alloc))(type, 0);
  if (self == NULL)
    return NULL;
  self->scene = Py_NewRef(scene);
  self->core = core;
  self->pid = getpid();
  const pl_status status = open_renderer(self);
  if (status != PL_OK) {
    Py_DECREF(self);
    return pl_py_raise(status);
  }
  return (PyObject *)self;
}

/* Runs Python's signal handlers at intervals while the GIL is released. */
typedef struct poller {
  PyThreadState *state; /* saved state of the calling thread */
  double next_s;
} poller;

static double now_s(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bool poll_signals(void *context) {
  const double period_s = 0.05;
  poller *poller = context;
  const double now = now_s();
  if (now < poller->next_s)
    return false;
  poller->next_s = now + period_s;
  PyEval_RestoreThread(poller->state);
  const int raised = PyErr_CheckSignals();
  poller->state = PyEval_SaveThread();
  return raised != 0;
}

static PyObject *plan_rows(const pl_plan *plan) {
  PyObject *rows = PyList_New((Py_ssize_t)plan->count);
  for (size_t i = 0; rows != NULL && i < plan->count; i++) {
    const pl_plan_row *row = &plan->rows[i];
    PyObject *entry =
        Py_BuildValue("{s:s,s:O,s:s,s:d,s:d,s:d,s:d,s:i,s:i}", "name", row->effect->name, "on",
                      row->value > 0 ? Py_True : Py_False, "reason", row->reason, "bound_dn",
                      row->bound_dn, "residual_dn", row->residual_dn, "spent_dn", row->spent_dn,
                      "cost_ms", row->cost_ms, "value", row->value, "ceiling", row->ceiling);
    if (entry == NULL)
      Py_CLEAR(rows);
    else
      PyList_SetItem(rows, (Py_ssize_t)i, entry);
  }
  return rows;
}

static PyObject *work_dict(const pl_work_counts *work) {
  PyObject *dict = PyDict_New();
  for (int i = 0; dict != NULL && i < PL_WORK_COUNT; i++) {
    PyObject *count = PyLong_FromUnsignedLongLong(work->of[i]);
    if (count == NULL || PyDict_SetItemString(dict, pl_work_name((pl_work)i), count) < 0)
      Py_CLEAR(dict);
    Py_XDECREF(count);
  }
  return dict;
}

static PyObject *result_dict(const pl_frame_result *result) {
  PyObject *timings = PyDict_New();
  for (int i = 0; timings != NULL && i < PL_STAGE_COUNT; i++) {
    PyObject *seconds = PyFloat_FromDouble(result->seconds[i]);
    if (seconds == NULL || PyDict_SetItemString(timings, pl_stage_name((pl_stage)i), seconds) < 0)
      Py_CLEAR(timings);
    Py_XDECREF(seconds);
  }
  PyObject *rows = timings != NULL ? plan_rows(&result->plan) : NULL;
  PyObject *stars = rows != NULL ? pl_py_seen_stars(result) : NULL;
  if (stars == NULL) {
    Py_XDECREF(timings);
    Py_XDECREF(rows);
    return NULL;
  }
  PyObject *work = work_dict(&result->work);
  if (work == NULL) {
    Py_DECREF(timings);
    Py_DECREF(rows);
    Py_DECREF(stars);
    return NULL;
  }
  return Py_BuildValue(
      "{s:N,s:n,s:O,s:d,s:d,s:d,s:N,s:N,s:N,s:{s:n,s:n,s:d,s:z,s:z}}", "work", work, "missed",
      (Py_ssize_t)result->missed, "aimed", result->aimed ? Py_True : Py_False, "white_radiance",
      result->white_radiance, "exposure_s", result->exposure_s, "gain_e_dn", result->gain, "plan",
      rows, "timings_s", timings, "stars", stars, "ground", "tiles",
      (Py_ssize_t)result->ground_tiles, "kept_bytes", (Py_ssize_t)result->ground_bytes, "widened",
      result->ground_widened, "widened_body", result->ground_widened_body, "missed_body",
      result->ground_missed_body);
}

void pl_py_renderer_end(pl_py_renderer *self) {
  PyObject *kept = self->states.kept;
  self->states.kept = NULL;
  pl_py_scene_release(self->scene);
  self->busy = 0;
  Py_XDECREF(kept); /* last, since it may run Python code too */
}

int pl_py_renderer_begin(pl_py_renderer *self) {
  if (self->pid != getpid()) {
    PyErr_SetString(PyExc_ValueError,
                    "this Renderer was made in another process; make one in each process");
    return -1;
  }
  if (self->busy) {
    PyErr_SetString(PyExc_ValueError, "this Renderer is already rendering a frame, in another "
                                      "thread or around this call");
    return -1;
  }
  if (pl_py_scene_hold(self->scene) < 0)
    return -1;
  self->busy = 1;
  self->states.kept = PyList_New(0);
  if (self->states.kept != NULL)
    return 0;
  pl_py_renderer_end(self);
  return -1;
}

pl_status pl_py_renderer_run(pl_frame_request *request, pl_status (*work)(void *), void *context) {
  poller poller = {NULL, now_s()};
  pl_cancel cancel = {.poll = poll_signals, .context = &poller};
  request->cancel = &cancel;
  poller.state = PyEval_SaveThread();
  const pl_status status = work(context);
  PyEval_RestoreThread(poller.state);
  request->cancel = NULL;
  return status;
}

typedef struct frame_work {
  pl_renderer *renderer;
  const pl_frame_request *request;
  pl_frame_result result;
  pl_status (*function)(pl_renderer *, const pl_frame_request *, pl_frame_result *);
} frame_work;

static pl_status make_frame(void *context) {
  frame_work *work = context;
  return work->function(work->renderer, work->request, &work->result);
}

static PyObject *run(pl_py_renderer *self, pl_frame_request *request,
                     pl_status (*function)(pl_renderer *, const pl_frame_request *,
                                           pl_frame_result *)) {
  frame_work work = {.renderer = self->renderer, .request = request, .function = function};
  const pl_status status = pl_py_renderer_run(request, make_frame, &work);
  return status == PL_OK ? result_dict(&work.result) : pl_py_raise(status);
}

static PyObject *renderer_render(PyObject *object, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"request", "out", "threads", "pilot", NULL};
  pl_py_renderer *self = (pl_py_renderer *)object;
  PyObject *request, *out, *result = NULL;
  pl_frame_request frame = {.threads = 1};
  int pilot = 0;
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OO|ip:render", names, &request, &out,
                                   &frame.threads, &pilot) ||
      pl_py_renderer_begin(self) < 0)
    return NULL;
  frame.pilot = pilot != 0;
  if (pl_py_request_parse(request, self->core, &self->states, &frame) == 0 &&
      pl_py_others_parse(request, self->core, self->others, &frame) == 0 &&
      pl_py_request_outputs(out, self->core, self->states.kept, &frame) == 0)
    result = run(self, &frame, pl_renderer_frame);
  pl_py_renderer_end(self);
  return result;
}

static PyObject *renderer_plan(PyObject *object, PyObject *request) {
  pl_py_renderer *self = (pl_py_renderer *)object;
  pl_frame_request frame = {.threads = 1};
  PyObject *result = NULL;
  if (pl_py_renderer_begin(self) < 0)
    return NULL;
  if (pl_py_request_parse(request, self->core, &self->states, &frame) == 0)
    result = run(self, &frame, pl_renderer_plan);
  pl_py_renderer_end(self);
  return result;
}

static PyObject *times_dict(const char *first, const pl_ray_times *a, const char *second,
                            const pl_ray_times *b) {
  return Py_BuildValue("{s:(ndd),s:(ndd)}", first, (Py_ssize_t)a->rays, a->ours_s, a->raw_s, second,
                       (Py_ssize_t)b->rays, b->ours_s, b->raw_s);
}

static PyObject *renderer_measure_rays(PyObject *object, PyObject *args) {
  pl_py_renderer *self = (pl_py_renderer *)object;
  PyObject *request;
  int repeats;
  pl_frame_request frame = {.threads = 1};
  if (!PyArg_ParseTuple(args, "Oi:measure_rays", &request, &repeats) ||
      pl_py_renderer_begin(self) < 0)
    return NULL;
  pl_ray_times primary, shadow;
  const int parsed = pl_py_request_parse(request, self->core, &self->states, &frame);
  pl_status status = PL_OK;
  if (parsed == 0) {
    Py_BEGIN_ALLOW_THREADS status =
        pl_measure_rays(self->core, &frame.placement, repeats, &primary, &shadow);
    Py_END_ALLOW_THREADS
  }
  pl_py_renderer_end(self);
  if (parsed < 0)
    return NULL;
  if (status != PL_OK)
    return pl_py_raise(status);
  return times_dict("primary", &primary, "shadow", &shadow);
}

static PyObject *renderer_measure_frame(PyObject *object, PyObject *args) {
  pl_py_renderer *self = (pl_py_renderer *)object;
  PyObject *request, *out;
  int repeats;
  pl_frame_request frame = {.threads = 1};
  if (!PyArg_ParseTuple(args, "OOi:measure_frame", &request, &out, &repeats) ||
      pl_py_renderer_begin(self) < 0)
    return NULL;
  pl_ray_times closest, shadow;
  pl_status status = PL_OK;
  const int parsed = pl_py_request_parse(request, self->core, &self->states, &frame) < 0 ||
                     pl_py_others_parse(request, self->core, self->others, &frame) < 0 ||
                     pl_py_request_outputs(out, self->core, self->states.kept, &frame) < 0;
  if (!parsed) {
    Py_BEGIN_ALLOW_THREADS status =
        pl_measure_frame(self->renderer, &frame, repeats, &closest, &shadow);
    Py_END_ALLOW_THREADS
  }
  pl_py_renderer_end(self);
  if (parsed)
    return NULL;
  return status == PL_OK ? times_dict("closest", &closest, "shadow", &shadow) : pl_py_raise(status);
}

static PyMethodDef renderer_methods[] = {
    {"measure_frame", renderer_measure_frame, METH_VARARGS,
     "Times all rays of a frame against raw Embree: for benchmarks."},
    {"measure_rays", renderer_measure_rays, METH_VARARGS,
     "Times a frame's rays against raw Embree: for benchmarks."},
    {"measure_scan", pl_py_renderer_measure_scan, METH_VARARGS,
     "Times the rays of a source against raw Embree: for benchmarks."},
    {"render", (PyCFunction)(void (*)(void))renderer_render, METH_VARARGS | METH_KEYWORDS,
     "Fills the arrays of `out`; returns exposure, plan and timings."},
    {"plan", renderer_plan, METH_O, "The plan of a frame, without rendering it."},
    {"trace", (PyCFunction)(void (*)(void))pl_py_renderer_trace, METH_VARARGS | METH_KEYWORDS,
     "Traces rays of a source: what they hit, with labels."},
    {"lidar", (PyCFunction)(void (*)(void))pl_py_renderer_lidar, METH_VARARGS | METH_KEYWORDS,
     "Scans with a LiDAR; returns an array of LIDAR_RETURN."},
    {"time_of_flight", (PyCFunction)(void (*)(void))pl_py_renderer_time_of_flight,
     METH_VARARGS | METH_KEYWORDS,
     "A picture of a time-of-flight camera: an array of TIME_OF_FLIGHT_PIXEL."},
    {"events", (PyCFunction)(void (*)(void))pl_py_renderer_events, METH_VARARGS | METH_KEYWORDS,
     "Events of an event camera in a time: an array of EVENT, and the number of pictures."},
    {NULL, NULL, 0, NULL},
};

static PyType_Slot renderer_slots[] = {
    {Py_tp_doc, "Renderer(scene)\n--\n\nRenders frames of one scene."},
    {Py_tp_new, (void *)renderer_new},
    {Py_tp_dealloc, (void *)renderer_dealloc},
    {Py_tp_methods, renderer_methods},
    {0, NULL},
};

PyType_Spec pl_py_renderer_spec = {"perilune._core.Renderer", sizeof(pl_py_renderer), 0,
                                   Py_TPFLAGS_DEFAULT, renderer_slots};
