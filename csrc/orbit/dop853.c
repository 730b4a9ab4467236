/* DOP853: the integration step, step-size control and dense output.
 *
 * After E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed.,
 * sections II.4 (automatic step size, starting step, PI control after Gustafsson 1991), II.5 and
 * II.6. */
#include "orbit/dop853.h"

#include <math.h>
#include <string.h>

#include "orbit/dop853_table.h"

#define SAFETY 0.9
#define SHRINK_MOST 0.333
#define GROW_MOST 6.0
/* Exponents of the PI controller. beta = 0.04 damps oscillations of the step size at small cost. */
#define BETA 0.04
#define ALPHA (1.0 / 8.0 - 0.2 * BETA)
#define ERROR_FLOOR 1e-4 /* lower limit of the last step's error in the PI controller */
#define TRIES 100        /* consecutive rejections; each reduces the step by a tenth or more */

typedef double stages[PL_DOP853_ALL][PL_ODE_SIZE];

static double length(const double *v, size_t count) {
  double sum = 0.0;
  for (size_t i = 0; i < count; i++)
    sum += v[i] * v[i];
  return sqrt(sum);
}

static void add_row(const pl_dop853_row *row, size_t size, stages k, double *out) {
  for (size_t i = 0; i < size; i++)
    out[i] = 0.0;
  for (int j = 0; j < row->count; j++) {
    const double weight = row->term[j].weight;
    const double *rate = k[row->term[j].stage];
    for (size_t i = 0; i < size; i++)
      out[i] += weight * rate[i];
  }
}

/* Root mean square of `v` relative to the scale of y and `other`, per vector. */
static double scaled_norm(const pl_ode *ode, const double *v, const double *y,
                          const double *other) {
  double sum = 0.0;
  for (size_t i = 0; i < ode->size; i += ode->vector) {
    const double at = length(y + i, ode->vector);
    const double scale =
        ode->atol + ode->rtol * fmax(at, other ? length(other + i, ode->vector) : at);
    const double part = length(v + i, ode->vector);
    /* a zero vector may have scale 0; NaN stays, so that the step is rejected */
    sum += part == 0.0 ? 0.0 : (part / scale) * (part / scale);
  }
  return sqrt(sum / (double)(ode->size / ode->vector));
}

static bool all_finite(const double *v, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (!isfinite(v[i]))
      return false;
  return true;
}

/* Chooses the first step by Hairer's algorithm, II.4. */
static pl_status first_step(const pl_ode *ode, int direction, pl_ode_point *p) {
  const double d0 = scaled_norm(ode, p->y, p->y, NULL);
  const double d1 = scaled_norm(ode, p->rate, p->y, NULL);
  const double h0 = isfinite(d1) && d0 > 1e-5 && d1 > 1e-5 ? 0.01 * (d0 / d1) : 1e-6;
  double y[PL_ODE_SIZE], rate[PL_ODE_SIZE], change[PL_ODE_SIZE];
  for (size_t i = 0; i < ode->size; i++)
    y[i] = p->y[i] + direction * h0 * p->rate[i];
  PL_TRY(ode->rate(ode->context, p->t + direction * h0, y, rate));
  for (size_t i = 0; i < ode->size; i++)
    change[i] = rate[i] - p->rate[i];
  const double d2 = scaled_norm(ode, change, p->y, NULL) / h0;
  const double most = fmax(d1, d2);
  double h1 = most > 1e-15 ? pow(0.01 / most, 1.0 / 8.0) : fmax(1e-6, 1e-3 * h0);
  if (!isfinite(h1) || !(h1 > 0.0))
    h1 = h0;
  p->h = direction * fmin(100.0 * h0, h1);
  return PL_OK;
}

pl_status pl_ode_start(const pl_ode *ode, double t, const double *y, int direction,
                       pl_ode_point *out) {
  memset(out, 0, sizeof *out);
  out->t = t;
  memcpy(out->y, y, ode->size * sizeof *y);
  out->error = ERROR_FLOOR;
  PL_TRY(ode->rate(ode->context, t, y, out->rate));
  if (!all_finite(out->y, ode->size) || !all_finite(out->rate, ode->size))
    return pl_fail(PL_E_RANGE, "the state or its rate at t = %.9g s is not finite", t);
  return first_step(ode, direction, out);
}

static pl_status evaluate(const pl_ode *ode, const pl_ode_point *p, double h, int stage, stages k) {
  double y[PL_ODE_SIZE], sum[PL_ODE_SIZE];
  add_row(&pl_dop853_stage[stage], ode->size, k, sum);
  for (size_t i = 0; i < ode->size; i++)
    y[i] = p->y[i] + h * sum[i];
  return ode->rate(ode->context, p->t + pl_dop853_node[stage] * h, y, k[stage]);
}

/* Error of a step relative to the tolerance: the estimate of order 5 corrected by that of order 3
 * (II.10.17). */
static double step_error(const pl_ode *ode, const double *y0, const double *y1, double h,
                         stages k) {
  double e5[PL_ODE_SIZE], e3[PL_ODE_SIZE];
  add_row(&pl_dop853_error5, ode->size, k, e5);
  add_row(&pl_dop853_error3, ode->size, k, e3);
  const double n5 = scaled_norm(ode, e5, y0, y1), n3 = scaled_norm(ode, e3, y0, y1);
  const double both = n5 * n5 + 0.01 * n3 * n3;
  return both == 0.0 ? 0.0 : fabs(h) * n5 * n5 / sqrt(both);
}

/* y1 = y0 + h k with Neumaier's compensated addition, which prevents the accumulation of rounding
 * errors over many small steps. */
static void advance(const pl_ode *ode, double h, const double *slope, pl_ode_point *to) {
  for (size_t i = 0; i < ode->size; i++) {
    const double change = h * slope[i] + to->carry[i];
    const double sum = to->y[i] + change;
    to->carry[i] =
        fabs(to->y[i]) >= fabs(change) ? (to->y[i] - sum) + change : (change - sum) + to->y[i];
    to->y[i] = sum;
  }
}

static pl_status dense_output(const pl_ode *ode, const pl_ode_point *from, const pl_ode_point *to,
                              double h, stages k, pl_ode_segment *out) {
  for (int stage = PL_DOP853_STAGES + 1; stage < PL_DOP853_ALL; stage++)
    PL_TRY(evaluate(ode, from, h, stage, k));
  memset(out, 0, sizeof *out);
  out->t = from->t;
  out->h = h;
  for (int j = 0; j < 4; j++) {
    add_row(&pl_dop853_dense[j], ode->size, k, out->c[4 + j]);
    for (size_t i = 0; i < ode->size; i++)
      out->c[4 + j][i] *= h;
  }
  for (size_t i = 0; i < ode->size; i++) {
    const double change = to->y[i] - from->y[i], bend = h * from->rate[i] - change;
    out->c[0][i] = from->y[i];
    out->c[1][i] = change;
    out->c[2][i] = bend;
    out->c[3][i] = change - h * to->rate[i] - bend;
  }
  return PL_OK;
}

/* Computes a trial step of h from `from`: the point after it and its error. */
static pl_status try_step(const pl_ode *ode, const pl_ode_point *from, double h, stages k,
                          pl_ode_point *to, double *error) {
  memcpy(k[0], from->rate, sizeof k[0]);
  for (int stage = 1; stage < PL_DOP853_STAGES; stage++)
    PL_TRY(evaluate(ode, from, h, stage, k));
  double slope[PL_ODE_SIZE];
  add_row(&pl_dop853_stage[PL_DOP853_STAGES], ode->size, k, slope);
  *to = *from;
  to->t = from->t + h;
  advance(ode, h, slope, to);
  *error = step_error(ode, from->y, to->y, h, k);
  return PL_OK;
}

pl_status pl_ode_step(const pl_ode *ode, double h_max, pl_ode_point *point,
                      pl_ode_segment *segment) {
  stages k;
  pl_ode_point to;
  double h = copysign(fmin(fabs(point->h), h_max), point->h);
  bool rejected = false;
  for (int tries = 0; tries < TRIES; tries++) {
    h = (point->t + h) - point->t; /* so that t + h is exact and time accumulates no error */
    if (!(fabs(h) > 4.0 * 0x1p-52 * fabs(point->t)))
      break;
    double error = 0.0;
    PL_TRY(try_step(ode, point, h, k, &to, &error));
    const double shrink = pow(error, ALPHA);
    if (!(error <= 1.0)) { /* also if it is NaN */
      const double by = isfinite(error) ? fmax(SHRINK_MOST, SAFETY / shrink) : SHRINK_MOST;
      h *= fmin(by, SAFETY);
      rejected = true;
      continue;
    }
    const double grow = SAFETY * pow(point->error, BETA) / shrink;
    const double by = fmin(fmax(grow, SHRINK_MOST), rejected ? 1.0 : GROW_MOST);
    PL_TRY(ode->rate(ode->context, to.t, to.y, to.rate));
    memcpy(k[PL_DOP853_STAGES], to.rate, sizeof to.rate);
    if (segment)
      PL_TRY(dense_output(ode, point, &to, h, k, segment));
    to.h = h * by;
    to.error = fmax(error, ERROR_FLOOR);
    *point = to;
    return PL_OK;
  }
  return pl_fail(PL_E_RANGE, "the step at t = %.9g s shrinks to nothing: a singularity", point->t);
}

void pl_ode_at(const pl_ode_segment *segment, size_t size, double t, double *y) {
  const double s = (t - segment->t) / segment->h, r = 1.0 - s;
  for (size_t i = 0; i < size; i++) {
    double sum = segment->c[7][i];
    for (int j = 6; j >= 0; j--)
      sum = segment->c[j][i] + sum * (j % 2 == 0 ? s : r);
    y[i] = sum;
  }
}
