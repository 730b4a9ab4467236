/* Solar radiation pressure on a sphere-like object, with the shadow of the centre.
 *
 * a = -nu P (AU/d)^2 Cr (A/m) u_sun, where nu is the visible fraction of the Sun's disc.
 * Montenbruck and Gill, Satellite Orbits, section 3.4. */
#include "base/memory.h"
#include "orbit/eclipse.h"
#include "orbit/force.h"

#define AU_M 149597870700.0
#define PRESSURE_PA (1361.0 / 299792458.0) /* at 1 AU: IAU 2015 nominal irradiance over c */

typedef struct radiation_pressure {
  pl_force base;
  double area_to_mass_m2_kg, cr, radius_m;
  const pl_propagator *sun; /* borrowed */
} radiation_pressure;

enum { AREA, CR, RADIUS, MOTION, PARAMETER_COUNT };
static const pl_force_parameter parameters[] = {
    {"area_to_mass_m2_kg", PL_FORCE_NUMBERS, 1, false, "area that faces the Sun over mass, m^2/kg"},
    {"cr", PL_FORCE_NUMBERS, 1, false,
     "1 where all light is absorbed, 2 where all is reflected back"},
    {"radius_m", PL_FORCE_NUMBERS, 1, false, "of the sphere that casts the shadow, m; 0 for none"},
    {"motion", PL_FORCE_MOTION, 0, false, "where the Sun is, relative to the centre"},
};

static pl_status create(const pl_force_setting *setting, const pl_force_value *values,
                        pl_force **out) {
  (void)setting;
  for (int i = AREA; i <= RADIUS; i++)
    if (values[i].numbers[0] < 0.0)
      return pl_fail(PL_E_RANGE, "%s must not be negative", parameters[i].key);
  radiation_pressure *self = NULL;
  PL_TRY(pl_alloc_or_fail(1, sizeof *self, "force", (void **)&self));
  self->base.kind = &pl_force_radiation_pressure;
  self->area_to_mass_m2_kg = values[AREA].numbers[0];
  self->cr = values[CR].numbers[0];
  self->radius_m = values[RADIUS].numbers[0];
  self->sun = values[MOTION].motion;
  *out = &self->base;
  return PL_OK;
}

static pl_status acceleration(const pl_force *force, const pl_force_point *at, pl_vec3 *out) {
  const radiation_pressure *self = (const radiation_pressure *)force;
  pl_state sun;
  PL_TRY(pl_propagator_states(self->sun, 1, &at->t_s, &sun));
  const double light = pl_eclipse_sunlight(at->r_m, sun.r_m, self->radius_m);
  const pl_vec3 away = pl_vec3_sub(at->r_m, sun.r_m);
  const double d = pl_vec3_norm(away), push = PRESSURE_PA * (AU_M / d) * (AU_M / d);
  *out = pl_vec3_scale(away, light * push * self->cr * self->area_to_mass_m2_kg / d);
  return PL_OK;
}

static pl_status regime(const pl_force *force, const pl_force_point *at, int *out) {
  const radiation_pressure *self = (const radiation_pressure *)force;
  pl_state sun;
  PL_TRY(pl_propagator_states(self->sun, 1, &at->t_s, &sun));
  *out = pl_eclipse_regime(at->r_m, sun.r_m, self->radius_m);
  return PL_OK;
}

const pl_force_kind pl_force_radiation_pressure = {
    .name = "radiation_pressure",
    .doc =
        "Sunlight on an object that looks the same from all sides, with umbra and penumbra of the "
        "centre as a sphere; no light reflected by the centre",
    .parameter_count = PARAMETER_COUNT,
    .parameters = parameters,
    .steps_per_turn = 20.0, /* a low orbit spends a third in shadow and 10 s in penumbra */
    .create = create,
    .acceleration = acceleration,
    .regime = regime,
};
