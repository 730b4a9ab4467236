/* The gravity of a point mass. */
#include "base/memory.h"
#include "orbit/force.h"

typedef struct point_mass {
  pl_force base;
  double gm_m3_s2;
} point_mass;

static const pl_force_parameter parameters[] = {
    {"gm", PL_FORCE_NUMBERS, 1, true, "m^3/s^2; default: the centre's"},
};

static pl_status create(const pl_force_setting *setting, const pl_force_value *values,
                        pl_force **out) {
  point_mass *self = NULL;
  PL_TRY(pl_alloc_or_fail(1, sizeof *self, "force", (void **)&self));
  self->base.kind = &pl_force_point_mass;
  self->gm_m3_s2 = values[0].count ? values[0].numbers[0] : setting->gm_m3_s2;
  *out = &self->base;
  return PL_OK;
}

static pl_status acceleration(const pl_force *force, const pl_force_point *at, pl_vec3 *out) {
  const point_mass *self = (const point_mass *)force;
  const double r2 = pl_vec3_dot(at->r_m, at->r_m);
  *out = pl_vec3_scale(at->r_m, -self->gm_m3_s2 / (r2 * sqrt(r2)));
  return PL_OK;
}

const pl_force_kind pl_force_point_mass = {
    .name = "point_mass",
    .doc = "The pull of all mass at the centre: two-body motion. Exact for a sphere",
    .parameter_count = 1,
    .parameters = parameters,
    .create = create,
    .acceleration = acceleration,
};
