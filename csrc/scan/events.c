/* Event pixels. Light is piecewise linear in its logarithm, so that crossings of thresholds have a
 * closed form. */
#include "scan/events.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "base/memory.h"
#include "sensor/draws.h"

static pl_status check_number(const char *name, double value, double least, bool above) {
  if (isfinite(value) && (above ? value > least : value >= least))
    return PL_OK;
  return pl_fail(PL_E_RANGE, "events: %s must be finite and %s %g, not %g", name,
                 above ? "above" : "at least", least, value);
}

pl_status pl_event_camera_check(const pl_event_camera *camera) {
  PL_TRY(check_number("on_threshold", camera->on, 0.0, true));
  PL_TRY(check_number("off_threshold", camera->off, 0.0, true));
  PL_TRY(check_number("mismatch", camera->mismatch, 0.0, false));
  PL_TRY(check_number("dark_radiance_w_m2_sr", camera->dark, 0.0, true));
  PL_TRY(check_number("refractory_us", camera->refractory_s, 0.0, false));
  PL_TRY(check_number("leak_hz", camera->leak_hz, 0.0, false));
  return check_number("noise_hz", camera->noise_hz, 0.0, false);
}

void pl_event_list_clear(pl_event_list *list) {
  pl_free(list->items);
  *list = (pl_event_list){.items = NULL};
}

static pl_status append(pl_event_list *list, double t_s, uint16_t x, uint16_t y, int8_t polarity) {
  if (list->count == list->room) {
    const size_t room = list->room > 0 ? 2 * list->room : 64;
    pl_event *grown = pl_realloc(list->items, room, sizeof *grown);
    if (grown == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for events");
    list->items = grown;
    list->room = room;
  }
  list->items[list->count++] = (pl_event){.t_us = 1e6 * t_s, .x = x, .y = y, .polarity = polarity};
  return PL_OK;
}

void pl_event_pixel_start(const pl_event_camera *camera, uint64_t pixel, double log_light,
                          pl_event_pixel *out) {
  const double least = 0.05; /* of the nominal threshold */
  pl_stream draws = pl_stream_of(camera->seed, PL_DRAW_THRESHOLD, pixel, 0);
  const double on = 1.0 + camera->mismatch * pl_stream_normal(&draws);
  const double off = 1.0 + camera->mismatch * pl_stream_normal(&draws);
  *out = (pl_event_pixel){
      .on = camera->on * fmax(on, least),
      .off = camera->off * fmax(off, least),
      .reference = log_light,
  };
}

pl_status pl_event_pixel_go(const pl_event_camera *camera, pl_event_pixel *pixel, uint16_t x,
                            uint16_t y, double t0, double t1, double l0, double l1,
                            pl_event_list *list) {
  const double slope = (l1 - l0) / (t1 - t0), leak = camera->leak_hz * pixel->on;
  double t = t0;
  for (;;) {
    if (pixel->waits) {
      if (pixel->awake_s >= t1)
        return PL_OK;
      t = fmax(t, pixel->awake_s);
      pixel->reference = l0 + slope * (t - t0);
      pixel->waits = 0;
    }
    /* the change since the last event, and how it grows while the reference leaks down */
    const double change = l0 + slope * (t - t0) - pixel->reference, rate = slope + leak;
    const double goal = rate > 0.0 ? pixel->on : -pixel->off;
    const double wait_s = (goal - change) / rate;
    if (rate == 0.0 || !(t + fmax(wait_s, 0.0) < t1)) {
      pixel->reference -= leak * (t1 - t);
      return PL_OK;
    }
    t += fmax(wait_s, 0.0);
    PL_TRY(append(list, t, x, y, rate > 0.0 ? 1 : -1));
    pixel->awake_s = t + camera->refractory_s;
    pixel->waits = 1;
  }
}

pl_status pl_event_noise(const pl_event_camera *camera, uint64_t pixel, uint16_t x, uint16_t y,
                         double duration_s, pl_event_list *list) {
  if (!(camera->noise_hz > 0.0))
    return PL_OK;
  pl_stream draws = pl_stream_of(camera->seed, PL_DRAW_EVENT, pixel, camera->frame);
  const double count = pl_stream_poisson(&draws, camera->noise_hz * duration_s);
  for (double k = 0.0; k < count; k += 1.0) {
    const double t = duration_s * pl_stream_uniform(&draws);
    PL_TRY(append(list, t, x, y, pl_stream_uniform(&draws) < 0.5 ? 1 : -1));
  }
  return PL_OK;
}

static int order(const void *a, const void *b) {
  const pl_event *one = a, *other = b;
  if (one->t_us != other->t_us)
    return one->t_us < other->t_us ? -1 : 1;
  if (one->y != other->y)
    return one->y < other->y ? -1 : 1;
  if (one->x != other->x)
    return one->x < other->x ? -1 : 1;
  return one->polarity - other->polarity;
}

void pl_events_sort(pl_event *events, size_t count) { qsort(events, count, sizeof *events, order); }
