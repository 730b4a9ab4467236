/* Atmospheres: checks of the settings, densities and phase functions. */
#include "air/air.h"

#include <math.h>

#include "air/table.h"
#include "base/memory.h"

static pl_status check_number(const char *name, double value, double low, double high) {
  if (isfinite(value) && value >= low && value <= high)
    return PL_OK;
  return pl_fail(PL_E_RANGE, "atmosphere: %s must be in %g..%g, not %g", name, low, high, value);
}

static pl_status check_bands(const char *name, const double values[3], double low, double high) {
  for (int k = 0; k < 3; k++)
    PL_TRY(check_number(name, values[k], low, high));
  return PL_OK;
}

/* Checks the numbers of an upper layer, if there is one. */
static pl_status check_upper(const char *name, double from_m, double height_m, double low,
                             double high) {
  PL_TRY(check_number("where the upper height begins", from_m, 0.0, high));
  return from_m > 0.0 ? check_number(name, height_m, low, high) : PL_OK;
}

static pl_status check(const pl_air_settings *s, double radius_m) {
  const double dense = 1e6, short_m = 1e-6, long_m = 1e15, peaked = 0.98;
  PL_TRY(check_number("the body's radius", radius_m, 1e-3, long_m));
  PL_TRY(check_bands("rayleigh scattering", s->rayleigh_scattering, 0.0, dense));
  PL_TRY(check_bands("mie scattering", s->mie_scattering, 0.0, dense));
  PL_TRY(check_bands("mie extinction", s->mie_extinction, 0.0, dense));
  PL_TRY(check_bands("ozone absorption", s->ozone_absorption, 0.0, dense));
  PL_TRY(check_bands("mie g", s->mie_g, -peaked, peaked));
  PL_TRY(check_bands("ground albedo", s->ground_albedo, 0.0, 1.0));
  PL_TRY(check_number("rayleigh scale height", s->rayleigh_height_m, short_m, long_m));
  PL_TRY(check_number("mie scale height", s->mie_height_m, short_m, long_m));
  PL_TRY(check_upper("rayleigh upper height", s->rayleigh_upper_from_m, s->rayleigh_upper_height_m,
                     short_m, long_m));
  PL_TRY(
      check_upper("mie upper height", s->mie_upper_from_m, s->mie_upper_height_m, short_m, long_m));
  PL_TRY(check_number("ozone centre", s->ozone_center_m, 0.0, long_m));
  PL_TRY(check_number("ozone width", s->ozone_width_m, short_m, long_m));
  PL_TRY(check_number("top", s->top_m, short_m, long_m));
  for (int k = 0; k < 3; k++)
    if (s->mie_scattering[k] > s->mie_extinction[k])
      return pl_fail(PL_E_RANGE, "atmosphere: mie scattering %g is more than its extinction %g",
                     s->mie_scattering[k], s->mie_extinction[k]);
  return PL_OK;
}

/* The corner between the two layers is rounded over this multiple of their mean scale height. */
static const double ROUND = 0.5;

static double hyperbola(const pl_air_layers *layers, double height_m) {
  const double x = height_m - layers->bend_m;
  return x + sqrt(x * x + layers->round_m * layers->round_m);
}

/* Density relative to that at the surface. */
static float layers_density(const pl_air_layers *layers, double height_m) {
  double exponent = height_m * layers->lower;
  if (layers->bent)
    exponent += layers->upper * (hyperbola(layers, height_m) - layers->offset_m);
  return expf((float)exponent);
}

static pl_air_layers layers_of(const pl_air_settings *s, double scale_m, double from_m,
                               double upper_m) {
  pl_air_layers out = {.scale_m = {scale_m, scale_m}, .bend_m = from_m, .lower = -1.0 / scale_m};
  if (from_m > 0.0) {
    out.bent = true;
    out.scale_m[1] = upper_m;
    out.upper = 0.5 * (1.0 / scale_m - 1.0 / upper_m);
    out.round_m = ROUND * 0.5 * (scale_m + upper_m);
    out.offset_m = hyperbola(&out, 0.0);
  }
  out.rest = layers_density(&out, s->top_m);
  return out;
}

static void set_optics(pl_air *air) {
  const pl_air_settings *s = &air->settings;
  air->layers[0] =
      layers_of(s, s->rayleigh_height_m, s->rayleigh_upper_from_m, s->rayleigh_upper_height_m);
  air->layers[1] = layers_of(s, s->mie_height_m, s->mie_upper_from_m, s->mie_upper_height_m);
  for (int k = 0; k < 3; k++) {
    air->scattering[0][k] = (float)s->rayleigh_scattering[k];
    air->scattering[1][k] = (float)s->mie_scattering[k];
    air->extinction[0][k] = (float)s->rayleigh_scattering[k];
    air->extinction[1][k] = (float)s->mie_extinction[k];
    air->extinction[2][k] = (float)s->ozone_absorption[k];
    for (int part = 0; part < PL_AIR_PARTS; part++)
      air->present[part] |= air->extinction[part][k] > 0.0f;
  }
}

pl_status pl_air_create(const pl_air_settings *settings, double radius_m, pl_air **out) {
  void *memory;
  PL_TRY(check(settings, radius_m));
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_air), "an atmosphere", &memory));
  pl_air *air = memory;
  air->settings = *settings;
  air->radius_m = radius_m;
  set_optics(air);
  pl_air_build_columns(air);
  pl_air_set_twilight(air);
  if (settings->multiple)
    pl_air_build_multiple(air);
  pl_air_build_sky(air);
  pl_air_build_light_bounds(air);
  *out = air;
  return PL_OK;
}

void pl_air_destroy(pl_air *air) { pl_free(air); }

const pl_air_settings *pl_air_settings_of(const pl_air *air) { return &air->settings; }

double pl_air_radius_m(const pl_air *air) { return air->radius_m; }

double pl_air_reach_m(const pl_air *air, double largest_m) {
  return largest_m * (1.0 + air->settings.top_m / air->radius_m);
}

double pl_air_layers_ratio(const pl_air_layers *layers, double height_m, double other_m) {
  double exponent = (other_m - height_m) * layers->lower;
  if (layers->bent)
    exponent += layers->upper * (hyperbola(layers, other_m) - hyperbola(layers, height_m));
  return exp(exponent);
}

void pl_air_density(const pl_air *air, double height_m, float out[PL_AIR_PARTS]) {
  const pl_air_settings *s = &air->settings;
  const bool inside = height_m <= s->top_m;
  const double off = fabs(height_m - s->ozone_center_m) / s->ozone_width_m;
  for (int part = 0; part < 2; part++)
    out[part] = inside ? layers_density(&air->layers[part], height_m) : 0.0f;
  out[2] = inside && off < 1.0 ? (float)(1.0 - off) : 0.0f;
}

float pl_air_rayleigh_phase(float cosine) {
  return 3.0f / (16.0f * PL_PI_F) * (1.0f + cosine * cosine);
}

float pl_air_mie_phase(float cosine, float g) {
  const float base = pl_maxf(1.0f + g * g - 2.0f * g * cosine, 1e-6f);
  return 3.0f / (8.0f * PL_PI_F) * (1.0f - g * g) * (1.0f + cosine * cosine) /
         ((2.0f + g * g) * base * sqrtf(base));
}

pl_vec3f pl_air_above(const pl_air *air, double height_m) {
  float density[PL_AIR_PARTS], part[3];
  pl_air_density(air, fmax(0.0, height_m), density);
  for (int k = 0; k < 3; k++) {
    const float gas = air->scattering[0][k] * (float)air->layers[0].scale_m[0];
    const float dust = air->scattering[1][k] * (float)air->layers[1].scale_m[0];
    part[k] = gas + dust > 0.0f ? (gas * density[0] + dust * density[1]) / (gas + dust) : 1.0f;
  }
  return pl_vec3f_make(part[0], part[1], part[2]);
}
