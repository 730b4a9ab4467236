/* The method events of Renderer. */
#include "pyext/py_ray_source.h"
#include "pyext/py_read.h"
#include "pyext/py_renderer.h"
#include "pyext/py_types.h"

#include "frame/events.h"

static int parse(PyObject *spec, const pl_frame_request *request, pl_event_settings *out) {
  const char *where = "events";
  pl_event_camera *camera = &out->camera;
  size_t instants = 0, halvings = 0;
  const struct {
    const char *key;
    double *value;
  } members[] = {
      {"on", &camera->on},
      {"off", &camera->off},
      {"mismatch", &camera->mismatch},
      {"dark", &camera->dark},
      {"refractory_s", &camera->refractory_s},
      {"leak_hz", &camera->leak_hz},
      {"noise_hz", &camera->noise_hz},
      {"tolerance", &out->tolerance},
      {"tolerated_pixels", &out->tolerated_pixels},
  };
  for (size_t i = 0; i < sizeof members / sizeof members[0]; i++)
    if (pl_py_member_double(spec, members[i].key, where, members[i].value) < 0)
      return -1;
  if (pl_py_member_size(spec, "instants", where, &instants) < 0 ||
      pl_py_member_size(spec, "halvings", where, &halvings) < 0)
    return -1;
  out->instants = instants <= PL_EVENT_INSTANTS_MAX ? (int)instants : -1;
  out->halvings = halvings <= PL_EVENT_HALVINGS_MAX ? (int)halvings : -1;
  camera->seed = request->seed;
  camera->frame = request->index;
  return 0;
}

typedef struct events_work {
  pl_renderer *renderer;
  const pl_frame_request *request;
  pl_event_settings settings;
  pl_event_list events;
  int pictures;
} events_work;

static pl_status make(void *context) {
  events_work *work = context;
  return pl_renderer_events(work->renderer, work->request, &work->settings, &work->events,
                            &work->pictures);
}

static PyObject *run(pl_py_renderer *self, pl_frame_request *request, events_work *work) {
  work->renderer = self->renderer;
  work->request = request;
  const pl_status status = pl_py_renderer_run(request, make, work);
  if (status != PL_OK)
    return pl_py_raise(status);
  PyObject *events =
      pl_py_records(pl_py_event(), work->events.items, work->events.count, sizeof(pl_event));
  pl_event_list_clear(&work->events);
  return events != NULL ? Py_BuildValue("(Ni)", events, work->pictures) : NULL;
}

PyObject *pl_py_renderer_events(PyObject *object, PyObject *args, PyObject *kwargs) {
  static char *names[] = {"request", "camera", "threads", NULL};
  pl_py_renderer *self = (pl_py_renderer *)object;
  PyObject *request, *camera, *result = NULL;
  pl_frame_request frame = {.threads = 1};
  events_work work = {.pictures = 0};
  if (!PyArg_ParseTupleAndKeywords(args, kwargs, "OO|i:events", names, &request, &camera,
                                   &frame.threads) ||
      pl_py_renderer_begin(self) < 0)
    return NULL;
  if (pl_py_request_parse(request, self->core, &self->states, &frame) == 0 &&
      parse(camera, &frame, &work.settings) == 0)
    result = run(self, &frame, &work);
  pl_py_renderer_end(self);
  return result;
}

PyObject *pl_py_event(void) {
  return Py_BuildValue("[(ss),(ss),(ss),(ss),(ss(i))]", "t_us", "<f8", "x", "<u2", "y", "<u2",
                       "polarity", "<i1", "unused", "<u1", 3);
}
