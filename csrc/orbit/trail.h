/* A solution that grows on demand in one direction of time and forgets without losing anything.
 *
 * Steps come in blocks of PL_TRAIL_BLOCK. Of every block the point where it begins is kept; the
 * segments of the blocks used last are kept too, those of others are computed again when asked for.
 * The steps depend on the start alone, so whatever is asked, in whatever order, the answers are the
 * same bits. Memory: sizeof(pl_ode_point) = 168 bytes a block, and at most PL_TRAIL_SLOTS blocks of
 * segments, 3.3 MB. Not thread-safe. */
#ifndef PL_ORBIT_TRAIL_H
#define PL_ORBIT_TRAIL_H

#include "orbit/dop853.h"

#define PL_TRAIL_BLOCK 128
#define PL_TRAIL_SLOTS 64
#define PL_TRAIL_BLOCKS_MAX (1u << 17) /* 16.8 million steps: more than 30 years of low orbit */

/* What the owner of a trail decides. */
typedef struct pl_trail_rules {
  double (*longest_step)(void *context, const pl_ode_point *from); /* > 0, may be infinite */
  /* Where within a step it should have ended instead, because the system is not smooth there: into
   * *t, or its end. */
  pl_status (*split)(void *context, const pl_ode_segment *segment, double *t);
  /* Whether the solution holds through a segment. If not, an error with its text, and in *last the
   * last time that is good: the trail ends there. */
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
  pl_ode_point *starts; /* owned; where block i begins */
  size_t known, capacity;
  bool ended;
  double last; /* ended: last good time */
  pl_status why;
  char why_text[240];
  pl_trail_slot slots[PL_TRAIL_SLOTS];
} pl_trail;

/* Zeroed memory is an empty trail, which clear takes too. Init takes the first point. */
pl_status pl_trail_init(pl_trail *trail, const pl_ode *ode, const pl_trail_rules *rules,
                        const pl_ode_point *start);
void pl_trail_clear(pl_trail *trail);

/* The solution at t, which lies at or beyond the start in the trail's direction. Errors: those that
 * ended the trail, when t is beyond its end; PL_E_RANGE past PL_TRAIL_BLOCKS_MAX; PL_E_MEMORY. */
pl_status pl_trail_at(pl_trail *trail, double t, double *y);

#endif
