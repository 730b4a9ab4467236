/* A solution that is extended on demand in one direction of time, in bounded memory.
 *
 * Steps are grouped in blocks of PL_TRAIL_BLOCK. The start point of every block is kept. The
 * segments are kept only for recently used blocks, and recomputed on demand for the others. The
 * steps depend on the start point only, so results are bit-identical for any sequence of requests.
 * Memory: sizeof(pl_ode_point) = 168 bytes per block, and at most PL_TRAIL_SLOTS blocks of
 * segments, 3.3 MB. Not thread-safe. */
#ifndef PL_ORBIT_TRAIL_H
#define PL_ORBIT_TRAIL_H

#include "orbit/dop853.h"

#define PL_TRAIL_BLOCK 128
#define PL_TRAIL_SLOTS 64
#define PL_TRAIL_BLOCKS_MAX (1u << 17) /* 16.8 million steps: more than 30 years of low orbit */

/* Callbacks of the owner of a trail. */
typedef struct pl_trail_rules {
  double (*longest_step)(void *context, const pl_ode_point *from); /* > 0, may be infinite */
  /* Writes to *t the time within a step at which it should end instead, because the system is not
   * smooth there. Otherwise leaves *t, the end of the step, unchanged. */
  pl_status (*split)(void *context, const pl_ode_segment *segment, double *t);
  /* Checks that the solution is valid throughout a segment. Otherwise returns an error with its
   * message and writes the last valid time to *last; the trail ends there. */
  pl_status (*check)(void *context, const pl_ode_segment *segment, double *last);
  void *context;
} pl_trail_rules;

typedef struct pl_trail_slot {
  size_t block, count;      /* count 0: empty */
  pl_ode_segment *segments; /* owned, PL_TRAIL_BLOCK; NULL until used */
} pl_trail_slot;

typedef struct pl_trail {
  const pl_ode *ode; /* borrowed */
  pl_trail_rules rules;
  pl_ode_point *starts; /* owned; start point of block i */
  size_t known, capacity;
  bool ended;
  double last; /* if ended: last valid time */
  pl_status why;
  char why_text[240];
  pl_trail_slot slots[PL_TRAIL_SLOTS];
} pl_trail;

/* Zeroed memory is an empty trail, which pl_trail_clear also accepts. pl_trail_init sets the first
 * point. */
pl_status pl_trail_init(pl_trail *trail, const pl_ode *ode, const pl_trail_rules *rules,
                        const pl_ode_point *start);
void pl_trail_clear(pl_trail *trail);

/* The solution at t, which lies at or after the start in the trail's direction. Fails with the
 * error that ended the trail if t is beyond its end; with PL_E_RANGE past PL_TRAIL_BLOCKS_MAX; with
 * PL_E_MEMORY. */
pl_status pl_trail_at(pl_trail *trail, double t, double *y);

#endif
