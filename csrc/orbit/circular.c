/* Positions on a scaled circle. */
#include "orbit/circular.h"

#include "base/memory.h"
#include "orbit/attitude.h"

typedef struct circular {
  pl_propagator base;
  pl_vec3 a_m, b_m; /* r = a cos u + b sin u */
  double start_rev, rate_rev_s;
} circular;

/* Phase in revolutions, in [-1, 1]. Whole revolutions are removed from the product before rounding.
 */
static double phase_rev(const circular *c, double t_s) {
  const double product = c->rate_rev_s * t_s;
  const double rest = fma(c->rate_rev_s, t_s, -product);
  return remainder(remainder(product, 1.0) + c->start_rev, 1.0) + rest;
}

static pl_status circular_states(const pl_propagator *self, size_t count, const double *t_s,
                                 pl_state *out) {
  const circular *c = (const circular *)self;
  const double speed = 2.0 * PL_PI * c->rate_rev_s;
  for (size_t i = 0; i < count; i++) {
    if (!isfinite(c->rate_rev_s * t_s[i]))
      return pl_fail(PL_E_RANGE, "%g s at %g revolutions a second is out of range", t_s[i],
                     c->rate_rev_s);
    const double u = 2.0 * PL_PI * phase_rev(c, t_s[i]), cu = cos(u), su = sin(u);
    out[i].r_m = pl_vec3_madd(pl_vec3_scale(c->a_m, cu), su, c->b_m);
    out[i].v_m_s = pl_vec3_madd(pl_vec3_scale(c->a_m, -su * speed), cu * speed, c->b_m);
  }
  return PL_OK;
}

static void circular_destroy(pl_propagator *self) { pl_free(self); }

const pl_propagator_kind pl_circular_kind = {
    .name = "circular",
    .doc = "A circle scaled along its axes, turned, and run through at a constant rate: Space "
           "OAISYS's orbits. Exact to rounding of the phase; a picture of an orbit, not a solution "
           "of the equations of motion.",
    .states = circular_states,
    .destroy = circular_destroy,
};

static pl_status check(const pl_circle *circle) {
  const pl_vec3 r = circle->radii_m;
  if (!(r.x > 0.0 && r.y > 0.0 && r.z > 0.0) || !isfinite(r.x + r.y + r.z))
    return pl_fail(PL_E_RANGE, "radii_m is (%g, %g, %g), but must be finite and positive", r.x, r.y,
                   r.z);
  if (!isfinite(circle->start_rev))
    return pl_fail(PL_E_RANGE, "start_rev is %g, but must be finite", circle->start_rev);
  if (!isfinite(circle->rate_rev_s))
    return pl_fail(PL_E_RANGE, "rate_rev_s is %g, but must be finite", circle->rate_rev_s);
  return pl_attitude_check(circle->q, "q");
}

pl_status pl_circular_create(const pl_circle *circle, pl_propagator **out) {
  PL_TRY(check(circle));
  circular *self = NULL;
  PL_TRY(pl_alloc_or_fail(1, sizeof *self, "circular propagator", (void **)&self));
  const pl_quat q = pl_quat_unit(circle->q);
  self->base.kind = &pl_circular_kind;
  self->a_m = pl_quat_rotate(q, pl_vec3_make(circle->radii_m.x, 0.0, 0.0));
  self->b_m = pl_quat_rotate(q, pl_vec3_make(0.0, circle->radii_m.y, 0.0));
  self->start_rev = remainder(circle->start_rev, 1.0);
  self->rate_rev_s = circle->rate_rev_s;
  *out = &self->base;
  return PL_OK;
}
