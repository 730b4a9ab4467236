/* Numerical propagator: equations of motion, termination at the surface, and two trails. */
#include "orbit/numerical.h"

#include <pthread.h>
#include <stdint.h>
#include <string.h>

#include "base/memory.h"
#include "orbit/trail.h"

#define BISECTIONS 60
/* A step is searched for changes of regime in this many parts. Changes are located to within
 * EDGE_S. Those closer to the start of the step than twice that belong to the previous step, which
 * ended there. */
#define EDGE_PARTS 8
#define EDGE_S 1e-6
#define REGIMES_MOST 1009u /* of one force; with more, some changes would be missed */

typedef struct numerical {
  pl_propagator base;
  pl_ode ode; /* its context is this struct */
  double gm_m3_s2, surface_m;
  double steps_per_turn; /* the largest value of any force; 0: no limit */
  bool has_regimes;      /* true if any force has regimes */
  size_t force_count;
  pl_force **forces; /* owned; the point mass comes first */
  size_t motion_count;
  pl_propagator **motions; /* owned */
  pthread_mutex_t lock;
  pl_trail trails[2]; /* after and before the epoch; protected by lock */
} numerical;

static pl_state state_of(const double *y) {
  return (pl_state){{y[0], y[1], y[2]}, {y[3], y[4], y[5]}};
}

static pl_status rate(void *context, double t, const double *y, double *out) {
  const numerical *self = context;
  const pl_state state = state_of(y);
  const pl_force_point at = {.t_s = t, .r_m = state.r_m, .v_m_s = state.v_m_s};
  pl_vec3 sum = {0.0, 0.0, 0.0};
  for (size_t i = self->force_count; i-- > 0;) { /* the first force, the largest, is added last */
    pl_vec3 one;
    PL_TRY(self->forces[i]->kind->acceleration(self->forces[i], &at, &one));
    sum = pl_vec3_add(sum, one);
  }
  memcpy(out, y + 3, 3 * sizeof *out);
  out[3] = sum.x;
  out[4] = sum.y;
  out[5] = sum.z;
  return PL_OK;
}

static double longest_step(void *context, const pl_ode_point *from) {
  const numerical *self = context;
  if (!(self->steps_per_turn > 0.0))
    return INFINITY;
  const double r = pl_vec3_norm(state_of(from->y).r_m);
  return 2.0 * PL_PI * r * sqrt(r / self->gm_m3_s2) / self->steps_per_turn;
}

/* Combined number of the regimes of all forces; changes with any of them. */
static pl_status regimes(const numerical *self, const pl_ode_segment *segment, double t,
                         uint64_t *out) {
  double y[6];
  pl_ode_at(segment, 6, t, y);
  const pl_state state = state_of(y);
  const pl_force_point at = {.t_s = t, .r_m = state.r_m, .v_m_s = state.v_m_s};
  *out = 0;
  for (size_t i = 0; i < self->force_count; i++)
    if (self->forces[i]->kind->regime) {
      int one = 0;
      PL_TRY(self->forces[i]->kind->regime(self->forces[i], &at, &one));
      *out = *out * REGIMES_MOST + (uint64_t)one;
    }
  return PL_OK;
}

/* Finds the time just after the first change of regime, or the end of the segment. */
static pl_status split(void *context, const pl_ode_segment *segment, double *t) {
  const numerical *self = context;
  const double sign = copysign(1.0, segment->h);
  if (!self->has_regimes || fabs(segment->h) <= 4.0 * EDGE_S)
    return PL_OK;
  double before = segment->t + sign * 2.0 * EDGE_S;
  uint64_t first, now;
  PL_TRY(regimes(self, segment, before, &first));
  for (int i = 1; i <= EDGE_PARTS; i++) {
    double beyond = i < EDGE_PARTS ? segment->t + segment->h * i / EDGE_PARTS : *t;
    PL_TRY(regimes(self, segment, beyond, &now));
    if (now == first) {
      before = beyond;
      continue;
    }
    while (fabs(beyond - before) > EDGE_S) {
      const double middle = 0.5 * (before + beyond);
      PL_TRY(regimes(self, segment, middle, &now));
      *(now == first ? &before : &beyond) = middle;
    }
    *t = beyond;
    return PL_OK;
  }
  return PL_OK;
}

static pl_state segment_at(const pl_ode_segment *segment, double t) {
  double y[6];
  pl_ode_at(segment, 6, t, y);
  return state_of(y);
}

/* Rate of change of the distance along the trail's direction, times the distance. */
static double receding(const pl_ode_segment *segment, double t) {
  const pl_state s = segment_at(segment, t);
  return copysign(pl_vec3_dot(s.r_m, s.v_m_s), pl_vec3_dot(s.r_m, s.v_m_s) * segment->h);
}

/* Time of the lowest point of a segment: an end, or the point at which the distance stops
 * decreasing. */
static double lowest_time(const pl_ode_segment *segment) {
  const double t0 = segment->t, t1 = segment->t + segment->h;
  if (receding(segment, t0) >= 0.0)
    return t0;
  if (receding(segment, t1) <= 0.0)
    return t1;
  double falling = t0, rising = t1;
  for (int i = 0; i < BISECTIONS; i++) {
    const double middle = 0.5 * (falling + rising);
    if (receding(segment, middle) < 0.0)
      falling = middle;
    else
      rising = middle;
  }
  return falling;
}

static pl_status check_surface(void *context, const pl_ode_segment *segment, double *last) {
  const numerical *self = context;
  if (!(self->surface_m > 0.0))
    return PL_OK;
  double below = lowest_time(segment), above = segment->t;
  if (!(pl_vec3_norm(segment_at(segment, below).r_m) < self->surface_m))
    return PL_OK;
  for (int i = 0; i < BISECTIONS; i++) {
    const double middle = 0.5 * (above + below);
    if (pl_vec3_norm(segment_at(segment, middle).r_m) < self->surface_m)
      below = middle;
    else
      above = middle;
  }
  *last = above;
  return pl_fail(PL_E_RANGE,
                 "the orbit meets the surface (%.6g km from the centre) %.9g s from the epoch",
                 1e-3 * self->surface_m, above);
}

static pl_status numerical_states(const pl_propagator *base, size_t count, const double *t_s,
                                  pl_state *out) {
  /* Logically const: only results that would be recomputed identically are cached. */
  numerical *self = (numerical *)base;
  pl_status status = PL_OK;
  pthread_mutex_lock(&self->lock);
  for (size_t i = 0; i < count && status == PL_OK; i++) {
    double y[6];
    status = isfinite(t_s[i]) ? pl_trail_at(&self->trails[t_s[i] < 0.0], t_s[i], y)
                              : pl_fail(PL_E_RANGE, "time %zu is not finite", i);
    if (status == PL_OK)
      out[i] = state_of(y);
  }
  pthread_mutex_unlock(&self->lock);
  return status;
}

static void numerical_destroy(pl_propagator *base) {
  numerical *self = (numerical *)base;
  for (int i = 0; i < 2; i++)
    pl_trail_clear(&self->trails[i]);
  for (size_t i = 0; self->forces && i < self->force_count; i++)
    pl_free(self->forces[i]);
  pl_free(self->forces);
  for (size_t i = 0; self->motions && i < self->motion_count; i++)
    pl_propagator_destroy(self->motions[i]);
  pl_free(self->motions);
  pthread_mutex_destroy(&self->lock);
  pl_free(self);
}

const pl_propagator_kind pl_numerical_kind = {
    .name = "numerical",
    .doc = "Equations of motion integrated by DOP853 with a table of forces; error by rtol and by "
           "what the forces leave out",
    .states = numerical_states,
    .destroy = numerical_destroy,
};

static bool finite3(pl_vec3 v) { return isfinite(v.x) && isfinite(v.y) && isfinite(v.z); }

static pl_status check_spec(const pl_numerical_spec *spec) {
  if (!finite3(spec->state.r_m) || !finite3(spec->state.v_m_s))
    return pl_fail(PL_E_RANGE, "the state is not finite");
  if (!isfinite(spec->setting.tdb_day) || !isfinite(spec->setting.tdb_fraction))
    return pl_fail(PL_E_RANGE, "the epoch is not finite");
  if (!(spec->setting.gm_m3_s2 > 0.0) || !isfinite(spec->setting.gm_m3_s2))
    return pl_fail(PL_E_RANGE, "gm = %g m^3/s^2 must be positive", spec->setting.gm_m3_s2);
  if (!(spec->rtol >= PL_NUMERICAL_RTOL_MIN && spec->rtol <= PL_NUMERICAL_RTOL_MAX))
    return pl_fail(PL_E_RANGE, "rtol = %g must be from %g to %g", spec->rtol, PL_NUMERICAL_RTOL_MIN,
                   PL_NUMERICAL_RTOL_MAX);
  const double r = pl_vec3_norm(spec->state.r_m);
  if (!(spec->surface_m >= 0.0) || !isfinite(spec->surface_m))
    return pl_fail(PL_E_RANGE, "surface_m must be finite and not negative");
  if (!(r > 0.0) || r < spec->surface_m)
    return pl_fail(PL_E_RANGE,
                   "at the epoch the orbit is %.6g km from the centre: below the "
                   "surface, %.6g km",
                   1e-3 * r, 1e-3 * spec->surface_m);
  return PL_OK;
}

/* Collects the point mass and the forces of the spec. The caller keeps ownership of the latter
 * until creation has succeeded. */
static pl_status collect_forces(numerical *self, const pl_numerical_spec *spec) {
  PL_TRY(pl_alloc_or_fail(spec->force_count + 1, sizeof(pl_force *), "forces",
                          (void **)&self->forces));
  const pl_force_value none = {0};
  PL_TRY(pl_force_create(&pl_force_point_mass, &spec->setting, &none, &self->forces[0]));
  self->force_count = 1;
  PL_TRY(pl_alloc_or_fail(spec->motion_count, sizeof(pl_propagator *), "forces",
                          (void **)&self->motions));
  for (size_t i = 0; i < spec->motion_count; i++)
    self->motions[i] = spec->motions[i];
  self->motion_count = spec->motion_count;
  for (size_t i = 0; i < spec->force_count; i++) {
    self->forces[i + 1] = spec->forces[i];
    self->steps_per_turn = fmax(self->steps_per_turn, spec->forces[i]->kind->steps_per_turn);
    self->has_regimes |= spec->forces[i]->kind->regime != NULL;
  }
  self->force_count = spec->force_count + 1;
  return PL_OK;
}

static pl_status start_trails(numerical *self, const pl_numerical_spec *spec) {
  const pl_vec3 r = spec->state.r_m, v = spec->state.v_m_s;
  const double y[6] = {r.x, r.y, r.z, v.x, v.y, v.z};
  const pl_trail_rules rules = {longest_step, split, check_surface, self};
  for (int i = 0; i < 2; i++) {
    pl_ode_point start;
    PL_TRY(pl_ode_start(&self->ode, 0.0, y, i == 0 ? 1 : -1, &start));
    PL_TRY(pl_trail_init(&self->trails[i], &self->ode, &rules, &start));
  }
  return PL_OK;
}

pl_status pl_numerical_create(const pl_numerical_spec *spec, pl_propagator **out) {
  PL_TRY(check_spec(spec));
  numerical *self = NULL;
  PL_TRY(pl_alloc_or_fail(1, sizeof *self, "orbit", (void **)&self));
  self->base.kind = &pl_numerical_kind;
  self->ode = (pl_ode){.size = 6, .vector = 3, .rtol = spec->rtol, .rate = rate, .context = self};
  self->gm_m3_s2 = spec->setting.gm_m3_s2;
  self->surface_m = spec->surface_m;
  pthread_mutex_init(&self->lock, NULL);
  pl_status status = collect_forces(self, spec);
  if (status == PL_OK)
    status = start_trails(self, spec);
  if (status != PL_OK) {
    self->motion_count = 0; /* the caller still owns everything except the point mass */
    self->force_count = self->force_count > 0 ? 1 : 0;
    numerical_destroy(&self->base);
    return status;
  }
  *out = &self->base;
  return PL_OK;
}
