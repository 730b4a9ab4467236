/* Events between two frames: pictures of instants, as many as the change of light needs. */
#ifndef PL_FRAME_EVENTS_H
#define PL_FRAME_EVENTS_H

#include "frame/frame.h"
#include "scan/events.h"

enum { PL_EVENT_HALVINGS_MAX = 12, PL_EVENT_INSTANTS_MAX = 4096 };

typedef struct pl_event_settings {
  pl_event_camera camera;
  int instants;     /* pictures that divide the time evenly: at least this many steps, >= 1 */
  int halvings;     /* a step is halved up to so many times */
  double tolerance; /* change of the logarithm, less the mean of its ends, that halves a step */
  double tolerated_pixels; /* fraction of the pixels that may be above it */
} pl_event_settings;

/* Appends the events of the request's exposure, sorted; *pictures is how many were made. */
pl_status pl_renderer_events(pl_renderer *renderer, const pl_frame_request *request,
                             const pl_event_settings *settings, pl_event_list *out, int *pictures);

#endif
