/* DOP853: adaptive Runge-Kutta of order 8 with dense output of order 7, for small systems. */
#ifndef PL_ORBIT_DOP853_H
#define PL_ORBIT_DOP853_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

#define PL_ODE_SIZE 6 /* most components of a system */

/* dy/dt at (t, y) into `rate`. An error ends the step with it. Must be a pure function: steps are
 * taken again when they have been forgotten, and must come out the same. */
typedef pl_status (*pl_ode_rate)(void *context, double t, const double *y, double *rate);

/* A system and how well to follow it. The error of a step is measured per vector (`vector`
 * consecutive components, e.g. a position) against atol + rtol times its length, so that it does
 * not matter how the axes lie; vector = 1 is the usual norm by components. */
typedef struct pl_ode {
  size_t size;   /* 1..PL_ODE_SIZE, a multiple of `vector` */
  size_t vector; /* >= 1 */
  double rtol, atol;
  pl_ode_rate rate;
  void *context; /* borrowed */
} pl_ode;

/* Everything the next step depends on. Copied at will: from a copy the same steps follow. */
typedef struct pl_ode_point {
  double t;
  double y[PL_ODE_SIZE];
  double carry[PL_ODE_SIZE]; /* what rounding has left out of y (compensated sum) */
  double rate[PL_ODE_SIZE];  /* at (t, y) */
  double h;                  /* step to try next; its sign is the direction */
  double error;              /* of the last step, for the PI control */
} pl_ode_point;

/* The solution over one step. */
typedef struct pl_ode_segment {
  double t, h;
  double c[8][PL_ODE_SIZE];
} pl_ode_segment;

/* The point at (t, y), with a first step in `direction` (+1 or -1) chosen from the rates there.
 * PL_E_RANGE when the rates are not finite. */
pl_status pl_ode_start(const pl_ode *ode, double t, const double *y, int direction,
                       pl_ode_point *out);

/* Advances `point` by one accepted step, not longer than `h_max` (> 0, may be infinite). `segment`
 * may be NULL: then the three evaluations of the dense output are spared; the steps are the same.
 * PL_E_RANGE when the step shrinks below the spacing of numbers near t: a singularity. After an
 * error `point` is as it was. Allocates nothing. */
pl_status pl_ode_step(const pl_ode *ode, double h_max, pl_ode_point *point,
                      pl_ode_segment *segment);

/* The solution at t within the segment; at its start exactly the point the step began with. */
void pl_ode_at(const pl_ode_segment *segment, size_t size, double t, double *y);

#endif
