/* Third-body gravity: the acceleration of the object minus that of the centre.
 *
 * Battin, An Introduction to the Mathematics and Methods of Astrodynamics, section 8.4: with the
 * body's position s, d = s - r, q = r.(r - 2 s)/s^2 and F = q (3 + 3 q + q^2)/(1 + (1 + q)^(3/2)),
 * the acceleration is a = -(gm/d^3) (r + F s). This avoids the difference of two nearly equal
 * accelerations. */
#include "base/memory.h"
#include "orbit/force.h"

typedef struct third_body {
  pl_force base;
  double gm_m3_s2;
  const pl_propagator *motion; /* borrowed */
} third_body;

enum { GM, MOTION, PARAMETER_COUNT };
static const pl_force_parameter parameters[] = {
    {"gm", PL_FORCE_NUMBERS, 1, false, "of the other body, m^3/s^2"},
    {"motion", PL_FORCE_MOTION, 0, false, "where the other body is, relative to the centre"},
};

static pl_status create(const pl_force_setting *setting, const pl_force_value *values,
                        pl_force **out) {
  (void)setting;
  third_body *self = NULL;
  PL_TRY(pl_alloc_or_fail(1, sizeof *self, "force", (void **)&self));
  self->base.kind = &pl_force_third_body;
  self->gm_m3_s2 = values[GM].numbers[0];
  self->motion = values[MOTION].motion;
  *out = &self->base;
  return PL_OK;
}

static pl_status acceleration(const pl_force *force, const pl_force_point *at, pl_vec3 *out) {
  const third_body *self = (const third_body *)force;
  pl_state other;
  PL_TRY(pl_propagator_states(self->motion, 1, &at->t_s, &other));
  const pl_vec3 r = at->r_m, s = other.r_m, d = pl_vec3_sub(s, r);
  const double q = pl_vec3_dot(r, pl_vec3_madd(r, -2.0, s)) / pl_vec3_dot(s, s);
  const double f = q * (3.0 + q * (3.0 + q)) / (1.0 + (1.0 + q) * sqrt(1.0 + q));
  const double d2 = pl_vec3_dot(d, d);
  *out = pl_vec3_scale(pl_vec3_madd(r, f, s), -self->gm_m3_s2 / (d2 * sqrt(d2)));
  return PL_OK;
}

const pl_force_kind pl_force_third_body = {
    .name = "third_body",
    .doc = "The pull of another body (as a point) that differs between the object and the centre",
    .parameter_count = PARAMETER_COUNT,
    .parameters = parameters,
    .create = create,
    .acceleration = acceleration,
};
