/* Root finding: sampling, golden-section search for extrema near zero, and Chandrupatla's method
 * between samples of different sign (Advances in Engineering Software 28, 145, 1997): inverse
 * quadratic interpolation where it is safe, otherwise bisection. */
#include "math/roots.h"

#include <float.h>
#include <math.h>

typedef struct sample {
  double t, f;
} sample;

typedef struct search {
  pl_function f;
  const void *context;
  double *roots;
  size_t count, capacity;
} search;

static sample at(const search *s, double t) { return (sample){t, s->f(s->context, t)}; }
static bool positive(sample a) { return a.f >= 0.0; }

/* Finds the root between two samples of different sign. */
static void add_root(search *s, sample b, sample a) {
  enum { ITERATIONS = 120 };
  sample c = b;
  double part = 0.5;
  for (int i = 0; i < ITERATIONS && fabs(a.f) + fabs(b.f) > 0.0; i++) {
    const sample next = at(s, a.t + part * (b.t - a.t));
    c = positive(next) == positive(a) ? a : b;
    b = positive(next) == positive(a) ? b : a;
    a = next;
    const double least = 2.0 * DBL_EPSILON * fmax(fabs(a.t), fabs(b.t)) / fabs(b.t - a.t);
    if (!(least < 0.5) || a.f == 0.0)
      break;
    const double xi = (a.t - b.t) / (c.t - b.t), phi = (a.f - b.f) / (c.f - b.f);
    part = 0.5;
    if (phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi)
      part = a.f / (b.f - a.f) * (c.f / (b.f - c.f)) +
             (c.t - a.t) / (b.t - a.t) * (a.f / (c.f - a.f)) * (b.f / (c.f - b.f));
    part = fmin(fmax(part, least), 1.0 - least);
  }
  if (s->count < s->capacity)
    s->roots[s->count++] = fabs(a.f) < fabs(b.f) ? a.t : b.t;
}

/* Between two samples of the same sign: finds two roots if the extremum of f in between has the
 * other sign. */
static void add_pair(search *s, sample low, sample high) {
  enum { ITERATIONS = 48 }; /* 0.618^48 = 1e-10 of the steps: an extremum is flat */
  const double golden = 0.6180339887498949;
  const bool sign = positive(low);
  sample c = at(s, high.t - golden * (high.t - low.t));
  sample d = at(s, low.t + golden * (high.t - low.t));
  sample a = low, b = high;
  for (int i = 0; i < ITERATIONS; i++) {
    const sample *through = positive(c) != sign ? &c : positive(d) != sign ? &d : NULL;
    if (through != NULL) {
      const sample middle = *through;
      add_root(s, low, middle);
      add_root(s, middle, high);
      return;
    }
    if (fabs(c.f) < fabs(d.f)) {
      b = d;
      d = c;
      c = at(s, b.t - golden * (b.t - a.t));
    } else {
      a = c;
      c = d;
      d = at(s, a.t + golden * (b.t - a.t));
    }
  }
}

/* falls_into, rises_out_of: true if |f| may have a minimum in step i without a change of sign at
 * its ends, judged by the step before and by the one after, in which f must not change its sign and
 * |f| must not decrease away from step i. */
static bool falls_into(const sample f[], int i, bool closed) {
  if (i == 0 && !closed)
    return true;
  const sample before = f[i == 0 ? PL_ROOTS_SAMPLES - 1 : i - 1];
  return positive(before) == positive(f[i]) && fabs(before.f) >= fabs(f[i].f);
}

static bool rises_out_of(const sample f[], int i, bool closed) {
  if (i == PL_ROOTS_SAMPLES - 1 && !closed)
    return true;
  const sample after = f[i == PL_ROOTS_SAMPLES - 1 ? 1 : i + 2];
  return positive(after) == positive(f[i]) && fabs(after.f) >= fabs(f[i + 1].f);
}

size_t pl_roots_find(pl_function f, const void *context, double from, double to, bool closed,
                     double *roots, size_t capacity) {
  enum { N = PL_ROOTS_SAMPLES };
  search s = {f, context, roots, 0, capacity};
  sample at_step[N + 1];
  for (int i = 0; i <= N; i++)
    at_step[i] = at(&s, from + (to - from) * i / N);
  if (closed)
    at_step[N].f = at_step[0].f;
  for (int i = 0; i < N; i++) {
    const sample a = at_step[i], b = at_step[i + 1];
    if (positive(a) != positive(b))
      add_root(&s, a, b);
    else if (falls_into(at_step, i, closed) && rises_out_of(at_step, i, closed))
      add_pair(&s, a, b);
  }
  return s.count;
}
