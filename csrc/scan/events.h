/* The pixels of an event camera: they report when the logarithm of their light has changed by a
 * threshold since their last report (Lichtsteiner, Posch, Delbruck 2008). */
#ifndef PL_SCAN_EVENTS_H
#define PL_SCAN_EVENTS_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

typedef struct pl_event_camera {
  uint64_t seed, frame;
  double on, off;      /* thresholds, changes of the natural logarithm, > 0 */
  double mismatch;     /* relative standard deviation of each pixel's thresholds */
  double dark;         /* radiance that adds to all light, W m-2 sr-1, > 0 */
  double refractory_s; /* after an event a pixel is held at what it then sees */
  double leak_hz;      /* ON events per second of a pixel under constant light */
  double noise_hz;     /* events per second of a pixel, of either polarity, at random */
} pl_event_camera;
/* Returns PL_E_RANGE, naming the value. */
pl_status pl_event_camera_check(const pl_event_camera *camera);

typedef struct pl_event {
  double t_us; /* since the start */
  uint16_t x, y;
  int8_t polarity; /* 1: brighter, -1: darker */
  uint8_t unused[3];
} pl_event;

typedef struct pl_event_list {
  pl_event *items; /* owned */
  size_t count, room;
} pl_event_list;
void pl_event_list_clear(pl_event_list *list);

/* A pixel between two instants. */
typedef struct pl_event_pixel {
  double on, off;   /* thresholds */
  double reference; /* logarithm that changes are measured from; it leaks */
  double awake_s;   /* it is held before */
  uint8_t waits;    /* held: the reference is set at awake_s */
} pl_event_pixel;

/* Sets a pixel at the start, at rest under light of this logarithm. */
void pl_event_pixel_start(const pl_event_camera *camera, uint64_t pixel, double log_light,
                          pl_event_pixel *out);
/* Appends the events of a pixel from t0 to t1, s, while the logarithm goes from l0 to l1 linearly.
 */
pl_status pl_event_pixel_go(const pl_event_camera *camera, pl_event_pixel *pixel, uint16_t x,
                            uint16_t y, double t0, double t1, double l0, double l1,
                            pl_event_list *list);
/* Appends the random events of a pixel in a time. */
pl_status pl_event_noise(const pl_event_camera *camera, uint64_t pixel, uint16_t x, uint16_t y,
                         double duration_s, pl_event_list *list);

/* Sorts by time, then row, then column, then polarity. */
void pl_events_sort(pl_event *events, size_t count);

#endif
