/* Atmospheric drag. The atmosphere rotates with the centre.
 *
 * a = -(rho/2) Cd (A/m) |v_rel| v_rel, v_rel = v - omega x r. rho is piecewise exponential in the
 * height above the ellipsoid. The default table is the Earth's: Vallado, Fundamentals of
 * Astrodynamics and Applications, table 8-4. The true density varies by a factor of 2 to 10 with
 * solar activity. */
#include "base/memory.h"
#include "orbit/force.h"
#include "orbit/turning.h"

#include <string.h>

/* A layer of the atmosphere: above height_m rho = density exp(-(h - height)/scale). */
typedef struct layer {
  double height_m, density_kg_m3, scale_m;
} layer;

static const layer earth_air[] = {
    {0e3, 1.225, 7.249e3},         {25e3, 3.899e-2, 6.349e3},    {30e3, 1.774e-2, 6.682e3},
    {40e3, 3.972e-3, 7.554e3},     {50e3, 1.057e-3, 8.382e3},    {60e3, 3.206e-4, 7.714e3},
    {70e3, 8.770e-5, 6.549e3},     {80e3, 1.905e-5, 5.799e3},    {90e3, 3.396e-6, 5.382e3},
    {100e3, 5.297e-7, 5.877e3},    {110e3, 9.661e-8, 7.263e3},   {120e3, 2.438e-8, 9.473e3},
    {130e3, 8.484e-9, 12.636e3},   {140e3, 3.845e-9, 16.149e3},  {150e3, 2.070e-9, 22.523e3},
    {180e3, 5.464e-10, 29.740e3},  {200e3, 2.789e-10, 37.105e3}, {250e3, 7.248e-11, 45.546e3},
    {300e3, 2.418e-11, 53.628e3},  {350e3, 9.518e-12, 53.298e3}, {400e3, 3.725e-12, 58.515e3},
    {450e3, 1.585e-12, 60.828e3},  {500e3, 6.967e-13, 63.822e3}, {600e3, 1.454e-13, 71.835e3},
    {700e3, 3.614e-14, 88.667e3},  {800e3, 1.170e-14, 124.64e3}, {900e3, 5.245e-15, 181.05e3},
    {1000e3, 3.019e-15, 268.00e3},
};
#define EARTH_LAYERS (sizeof earth_air / sizeof earth_air[0])

typedef struct drag {
  pl_force base;
  pl_turning turning;
  double area_to_mass_m2_kg, cd;
  double equatorial_m, polar_m;
  size_t count;
  layer air[];
} drag;

enum { AREA = PL_TURNING_COUNT, CD, RADII, AIR, PARAMETER_COUNT };
static const pl_force_parameter parameters[] = {
    PL_TURNING_PARAMETERS,
    {"area_to_mass_m2_kg", PL_FORCE_NUMBERS, 1, false, "area across the motion over mass, m^2/kg"},
    {"cd", PL_FORCE_NUMBERS, 1, false, "drag coefficient, about 2.2"},
    {"radii_m", PL_FORCE_NUMBERS, 2, false, "equatorial and polar radius of the surface, m"},
    {"air", PL_FORCE_NUMBERS, 0, true,
     "layers upwards, three numbers each: height m, density kg/m^3 there, scale height m; default: "
     "the Earth's"},
};

static pl_status check(const pl_force_value *values) {
  for (int i = AREA; i <= RADII; i++)
    for (size_t k = 0; k < values[i].count; k++)
      if (values[i].numbers[k] < 0.0 || (i == RADII && values[i].numbers[k] == 0.0))
        return pl_fail(PL_E_RANGE, "%s must %s", parameters[i].key,
                       i == RADII ? "be positive" : "not be negative");
  const double *air = values[AIR].numbers;
  if (values[AIR].count % 3 != 0)
    return pl_fail(PL_E_ARGUMENT, "air must have three numbers a layer, has %zu in all",
                   values[AIR].count);
  for (size_t i = 0; i < values[AIR].count; i += 3)
    if (air[i + 1] < 0.0 || !(air[i + 2] > 0.0) || (i > 0 && !(air[i] > air[i - 3])))
      return pl_fail(PL_E_RANGE,
                     "air, layer %zu: heights must rise, densities not be negative, scale heights "
                     "be positive",
                     i / 3);
  return PL_OK;
}

static pl_status create(const pl_force_setting *setting, const pl_force_value *values,
                        pl_force **out) {
  PL_TRY(check(values));
  pl_turning turning;
  PL_TRY(pl_turning_init(setting, values, &turning));
  const bool given = values[AIR].count > 0;
  const size_t count = given ? values[AIR].count / 3 : EARTH_LAYERS;
  drag *self = NULL;
  PL_TRY(pl_alloc_or_fail(1, sizeof *self + count * sizeof *self->air, "force", (void **)&self));
  self->base.kind = &pl_force_drag;
  self->turning = turning;
  self->area_to_mass_m2_kg = values[AREA].numbers[0];
  self->cd = values[CD].numbers[0];
  self->equatorial_m = values[RADII].numbers[0];
  self->polar_m = values[RADII].numbers[1];
  self->count = count;
  memcpy(self->air, given ? (const void *)values[AIR].numbers : (const void *)earth_air,
         count * sizeof *self->air);
  *out = &self->base;
  return PL_OK;
}

/* Height above the spheroid by Bowring's formula, with an error below a metre up to 2000 km. */
static double height(const drag *self, double across_m, double along_m) {
  const double a = self->equatorial_m, b = self->polar_m;
  const double e2 = (a - b) * (a + b) / (a * a), e2_b = (a - b) * (a + b) / (b * b);
  const double beta = atan2(along_m * a, across_m * b), s = sin(beta), c = cos(beta);
  const double phi = atan2(along_m + e2_b * b * s * s * s, across_m - e2 * a * c * c * c);
  const double sp = sin(phi);
  return across_m * cos(phi) + along_m * sp - a * sqrt(1.0 - e2 * sp * sp);
}

/* Index of the layer at a height; the lowest layer below all layers. */
static size_t layer_at(const drag *self, double h) {
  size_t at = 0;
  while (at + 1 < self->count && h >= self->air[at + 1].height_m)
    at++;
  return at;
}

/* Density, kg/m^3. Below the lowest layer it is that at the layer's base; above the highest layer
 * its exponential continues. */
static double density(const drag *self, double h) {
  const layer *l = &self->air[layer_at(self, h)];
  return l->density_kg_m3 * exp(-fmax(h - l->height_m, 0.0) / l->scale_m);
}

static double height_at(const drag *self, pl_vec3 pole, pl_vec3 r) {
  return height(self, pl_vec3_norm(pl_vec3_cross(r, pole)), pl_vec3_dot(r, pole));
}

static pl_status acceleration(const pl_force *force, const pl_force_point *at, pl_vec3 *out) {
  const drag *self = (const drag *)force;
  const pl_vec3 pole = pl_turning_pole(&self->turning, at->t_s);
  const pl_vec3 omega = pl_vec3_scale(pole, pl_turning_rate_rad_s(&self->turning));
  const double rho = density(self, height_at(self, pole, at->r_m));
  const pl_vec3 wind = pl_vec3_sub(at->v_m_s, pl_vec3_cross(omega, at->r_m));
  *out = pl_vec3_scale(wind, -0.5 * rho * self->cd * self->area_to_mass_m2_kg * pl_vec3_norm(wind));
  return PL_OK;
}

static pl_status regime(const pl_force *force, const pl_force_point *at, int *out) {
  const drag *self = (const drag *)force;
  *out = (int)layer_at(self, height_at(self, pl_turning_pole(&self->turning, at->t_s), at->r_m));
  return PL_OK;
}

const pl_force_kind pl_force_drag = {
    .name = "drag",
    .doc = "Drag by air of piecewise exponential density that turns with the centre; without the "
           "Sun's activity its density is good to a factor of 2 to 10",
    .parameter_count = PARAMETER_COUNT,
    .parameters = parameters,
    .create = create,
    .acceleration = acceleration,
    .regime = regime,
};
