/* Zonal harmonics of the centre: flattening (J2) and higher terms.
 *
 * a = sum_n (gm J_n R^n / r^(n+2)) (P'_{n+1}(s) r^ - P'_n(s) z^), where s is the sine of the
 * latitude. This is the gradient of the zonal terms, by P'_{n+1} = (n+1) P_n + s P'_n, and is
 * regular at the poles. Montenbruck and Gill, Satellite Orbits, section 3.2. */
#include "base/memory.h"
#include "orbit/force.h"
#include "orbit/turning.h"

#include <string.h>

#define FIRST_DEGREE 2

typedef struct zonal {
  pl_force base;
  pl_turning turning;
  double gm_m3_s2, radius_m;
  size_t count;
  double j[]; /* from J2 */
} zonal;

enum { RADIUS = PL_TURNING_COUNT, J, GM, PARAMETER_COUNT };
static const pl_force_parameter parameters[] = {
    PL_TURNING_PARAMETERS,
    {"radius_m", PL_FORCE_NUMBERS, 1, false, "reference radius of the harmonics, m"},
    {"j", PL_FORCE_NUMBERS, 0, false, "J2, J3, ...: as many as are meant, not normalised"},
    {"gm", PL_FORCE_NUMBERS, 1, true, "m^3/s^2 that goes with them; default: the centre's"},
};

static pl_status create(const pl_force_setting *setting, const pl_force_value *values,
                        pl_force **out) {
  const size_t count = values[J].count;
  if (!(values[RADIUS].numbers[0] > 0.0))
    return pl_fail(PL_E_RANGE, "radius_m must be positive");
  zonal *self = NULL;
  PL_TRY(pl_alloc_or_fail(1, sizeof *self + count * sizeof *self->j, "force", (void **)&self));
  self->base.kind = &pl_force_zonal;
  self->gm_m3_s2 = values[GM].count ? values[GM].numbers[0] : setting->gm_m3_s2;
  self->radius_m = values[RADIUS].numbers[0];
  self->count = count;
  memcpy(self->j, values[J].numbers, count * sizeof *self->j);
  const pl_status status = pl_turning_init(setting, values, &self->turning);
  if (status != PL_OK) {
    pl_free(self);
    return status;
  }
  *out = &self->base;
  return PL_OK;
}

static pl_status acceleration(const pl_force *force, const pl_force_point *at, pl_vec3 *out) {
  const zonal *self = (const zonal *)force;
  const pl_vec3 pole = pl_turning_pole(&self->turning, at->t_s);
  const double r = pl_vec3_norm(at->r_m), ratio = self->radius_m / r;
  const pl_vec3 up = pl_vec3_scale(at->r_m, 1.0 / r);
  const double s = pl_vec3_dot(up, pole);
  double scale = self->gm_m3_s2 / (r * r) * ratio; /* gm R^n / r^(n+2) */
  double p = s, p_below = 1.0, slope = 1.0;        /* P_n, P_{n-1}, P'_n; from n = 1 */
  double along_up = 0.0, along_pole = 0.0;
  for (size_t k = 0; k < self->count; k++) {
    const double n = (double)(k + FIRST_DEGREE);
    const double next = ((2.0 * n - 1.0) * s * p - (n - 1.0) * p_below) / n;
    slope = n * p + s * slope;
    p_below = p;
    p = next;
    scale *= ratio;
    along_up += scale * self->j[k] * ((n + 1.0) * p + s * slope);
    along_pole -= scale * self->j[k] * slope;
  }
  *out = pl_vec3_madd(pl_vec3_scale(up, along_up), along_pole, pole);
  return PL_OK;
}

const pl_force_kind pl_force_zonal = {
    .name = "zonal",
    .doc =
        "Zonal harmonics J2, J3, ... about the centre's pole of date; the same at all longitudes",
    .parameter_count = PARAMETER_COUNT,
    .parameters = parameters,
    .create = create,
    .acceleration = acceleration,
};
