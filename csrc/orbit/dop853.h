/* DOP853: adaptive Runge-Kutta method of order 8 with dense output of order 7, for small systems.
 */
#ifndef PL_ORBIT_DOP853_H
#define PL_ORBIT_DOP853_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

#define PL_ODE_SIZE 6 /* largest number of components of a system */

/* Writes dy/dt at (t, y) to `rate`. An error aborts the step and is returned. Must be a pure
 * function: discarded steps are recomputed later and must be identical. */
typedef pl_status (*pl_ode_rate)(void *context, double t, const double *y, double *rate);

/* A system of equations and its tolerance. The error of a step is measured per vector (`vector`
 * consecutive components, e.g. a position) relative to atol + rtol times its length, so that it
 * does not depend on the orientation of the axes. vector = 1 is the usual componentwise norm. */
typedef struct pl_ode {
  size_t size;   /* 1..PL_ODE_SIZE, a multiple of `vector` */
  size_t vector; /* >= 1 */
  double rtol, atol;
  pl_ode_rate rate;
  void *context; /* borrowed */
} pl_ode;

/* Complete state of the integrator. It may be copied; a copy continues with the same steps. */
typedef struct pl_ode_point {
  double t;
  double y[PL_ODE_SIZE];
  double carry[PL_ODE_SIZE]; /* rounding error of y (compensated sum) */
  double rate[PL_ODE_SIZE];  /* at (t, y) */
  double h;                  /* next trial step; its sign is the direction */
  double error;              /* of the last step, for the PI controller */
} pl_ode_point;

/* Dense output: the solution over one step. */
typedef struct pl_ode_segment {
  double t, h;
  double c[8][PL_ODE_SIZE];
} pl_ode_segment;

/* Initializes the point at (t, y), with a first step in `direction` (+1 or -1) chosen from the
 * rates there. Fails with PL_E_RANGE if the rates are not finite. */
pl_status pl_ode_start(const pl_ode *ode, double t, const double *y, int direction,
                       pl_ode_point *out);

/* Advances `point` by one accepted step, not longer than `h_max` (> 0, may be infinite). `segment`
 * may be NULL: this saves the three evaluations for the dense output and does not change the steps.
 * Fails with PL_E_RANGE if the step becomes smaller than the spacing of numbers near t, at a
 * singularity. After an error `point` is unchanged. Does not allocate memory. */
pl_status pl_ode_step(const pl_ode *ode, double h_max, pl_ode_point *point,
                      pl_ode_segment *segment);

/* The solution at t within the segment. At the start of the segment it is exactly the point at
 * which the step began. */
void pl_ode_at(const pl_ode_segment *segment, size_t size, double t, double *y);

#endif
