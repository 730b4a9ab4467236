/* Trail of integration steps: extension, recomputation and lookup. */
#include "orbit/trail.h"

#include <math.h>
#include <stdio.h>

#include "base/memory.h"

#define FIRST_CAPACITY 16

pl_status pl_trail_init(pl_trail *trail, const pl_ode *ode, const pl_trail_rules *rules,
                        const pl_ode_point *start) {
  trail->ode = ode;
  trail->rules = *rules;
  PL_TRY(pl_alloc_or_fail(FIRST_CAPACITY, sizeof *trail->starts, "steps of an orbit",
                          (void **)&trail->starts));
  trail->capacity = FIRST_CAPACITY;
  trail->starts[0] = *start;
  trail->known = 1;
  return PL_OK;
}

void pl_trail_clear(pl_trail *trail) {
  for (size_t i = 0; i < PL_TRAIL_SLOTS; i++)
    pl_free(trail->slots[i].segments);
  pl_free(trail->starts);
}

/* Difference t - of along the direction of the trail. */
static double ahead(const pl_trail *trail, double t, double of) {
  return copysign(1.0, trail->starts[0].h) * (t - of);
}

/* Ensures capacity for one more start. */
static pl_status reserve(pl_trail *trail) {
  if (trail->known < trail->capacity)
    return PL_OK;
  pl_ode_point *more = pl_realloc(trail->starts, 2 * trail->capacity, sizeof *more);
  if (!more)
    return pl_fail(PL_E_MEMORY, "out of memory for the steps of an orbit");
  trail->starts = more;
  trail->capacity *= 2;
  return PL_OK;
}

/* Takes one step, and repeats it shortened if the rules require it. The shortened step is not
 * tested again. */
static pl_status step_once(const pl_trail *trail, pl_ode_point *at, pl_ode_segment *segment) {
  const pl_ode_point before = *at;
  const double h_max = trail->rules.longest_step(trail->rules.context, at);
  PL_TRY(pl_ode_step(trail->ode, h_max, at, segment));
  double end = at->t;
  const pl_status status = trail->rules.split(trail->rules.context, segment, &end);
  if (status != PL_OK || end != at->t)
    *at = before;
  if (status != PL_OK || end == segment->t + segment->h)
    return status;
  return pl_ode_step(trail->ode, fabs(end - before.t), at, segment);
}

/* Integrates a block into `slot`, up to its end or the end of the trail. `at` advances. */
static pl_status step_block(const pl_trail *trail, pl_trail_slot *slot, pl_ode_point *at,
                            double *last) {
  for (slot->count = 0; slot->count < PL_TRAIL_BLOCK; slot->count++) {
    *last = at->t;
    pl_ode_segment *segment = &slot->segments[slot->count];
    PL_TRY(step_once(trail, at, segment));
    *last = at->t;
    const pl_status status = trail->rules.check(trail->rules.context, segment, last);
    if (status != PL_OK) {
      slot->count++; /* valid up to *last */
      return status;
    }
  }
  return PL_OK;
}

/* Computes the block's segments in its slot, unless they are there already. */
static pl_status load(pl_trail *trail, size_t block, pl_trail_slot **out) {
  pl_trail_slot *slot = &trail->slots[block % PL_TRAIL_SLOTS];
  *out = slot;
  if (slot->count > 0 && slot->block == block)
    return PL_OK;
  if (!slot->segments)
    PL_TRY(pl_alloc_or_fail(PL_TRAIL_BLOCK, sizeof *slot->segments, "steps of an orbit",
                            (void **)&slot->segments));
  const bool frontier = block + 1 == trail->known && !trail->ended;
  if (frontier)
    PL_TRY(reserve(trail));
  pl_ode_point at = trail->starts[block];
  double last = at.t;
  const pl_status status = step_block(trail, slot, &at, &last);
  slot->block = block;
  if (status == PL_E_MEMORY) { /* a later call may succeed */
    slot->count = 0;
    return status;
  }
  if (!frontier)
    return PL_OK; /* the end is already known */
  if (status == PL_OK) {
    trail->starts[trail->known++] = at;
    return PL_OK;
  }
  trail->ended = true;
  trail->last = last;
  trail->why = status;
  snprintf(trail->why_text, sizeof trail->why_text, "%s", pl_error_text());
  return PL_OK;
}

static pl_status grow_to(pl_trail *trail, double t) {
  while (!trail->ended && ahead(trail, t, trail->starts[trail->known - 1].t) >= 0.0) {
    if (trail->known > PL_TRAIL_BLOCKS_MAX)
      return pl_fail(PL_E_RANGE,
                     "t = %.9g s is more than %u steps from the epoch, which is the limit; they "
                     "reach t = %.9g s: loosen rtol, or set the epoch nearer",
                     t, PL_TRAIL_BLOCKS_MAX * PL_TRAIL_BLOCK, trail->starts[trail->known - 1].t);
    pl_trail_slot *slot = NULL;
    PL_TRY(load(trail, trail->known - 1, &slot));
  }
  if (trail->ended && ahead(trail, t, trail->last) > 0.0)
    return pl_fail(trail->why, "%s", trail->why_text);
  return PL_OK;
}

pl_status pl_trail_at(pl_trail *trail, double t, double *y) {
  PL_TRY(grow_to(trail, t));
  size_t low = 0, high = trail->known; /* the block: starts[low] is not after t, starts[high] is */
  while (high - low > 1) {
    const size_t middle = low + (high - low) / 2;
    if (ahead(trail, t, trail->starts[middle].t) >= 0.0)
      low = middle;
    else
      high = middle;
  }
  pl_trail_slot *slot = NULL;
  PL_TRY(load(trail, low, &slot));
  size_t first = 0, beyond = slot->count;
  while (beyond - first > 1) {
    const size_t middle = first + (beyond - first) / 2;
    if (ahead(trail, t, slot->segments[middle].t) >= 0.0)
      first = middle;
    else
      beyond = middle;
  }
  if (slot->count == 0) /* the trail ended in its first step; t is its start */
    for (size_t i = 0; i < trail->ode->size; i++)
      y[i] = trail->starts[low].y[i];
  else
    pl_ode_at(&slot->segments[first], trail->ode->size, t, y);
  return PL_OK;
}
