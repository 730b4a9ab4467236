/* The photometric models as nodes of material graphs: converts sockets to parameters. */
#include <math.h>

#include "shade/material_surface.h"
#include "shade/regolith.h"
#include "shade/regolith_law.h"

/* Fallbacks are the medians of Sato et al. 2014 at 643 nm for the Moon between 30 S and 30 N. */
#define PHASE_INPUTS                                                                               \
  {"b", PL_COLOR, {0.2375f, 0.2375f, 0.2375f}, "Width of the phase function's lobes, 0..0.95"},    \
      {"c", PL_COLOR, {0.3253f, 0.3253f, 0.3253f}, "Weight of its backward lobe, -2..2"},          \
      {"b_s0", PL_COLOR, {1.686f, 1.686f, 1.686f}, "Height of the shadow-hiding surge, 0..10"},    \
      {"h_s", PL_COLOR, {0.0672f, 0.0672f, 0.0672f}, "Its half width, 0..10; 0: none"},

const pl_socket pl_regolith_inputs[PL_REGOLITH_INPUTS] = {
    PHASE_INPUTS{"b_c0", PL_COLOR, {0.0f, 0.0f, 0.0f}, "Height of the coherent surge, 0..10"},
    {"h_c", PL_COLOR, {0.01f, 0.01f, 0.01f}, "Its half width, 0..10; 0: none"},
    {"filling", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "Part of the volume that grains fill, 0..0.75"},
    {"roughness_deg", PL_SCALAR, {23.657f, 23.657f, 23.657f}, "Mean slope of the relief, 0..60"},
};

enum { LIMB = PL_REGOLITH_PHASE_INPUTS };
const pl_socket pl_minnaert_inputs[PL_REGOLITH_PHASE_INPUTS + 1] = {
    PHASE_INPUTS{"k", PL_SCALAR, {0.55f, 0.55f, 0.55f}, "Minnaert's exponent, 0..2; 1 is Lambert"}};

/* Largest values, in the order of the inputs; fmin and fmax return the number if one argument is
 * NaN. */
static const float HIGH[] = {0.95f, 2.0f, 10.0f, 10.0f, 10.0f, 10.0f, 0.75f, 60.0f};

static float value_of(const pl_surface_inputs *in, size_t k, size_t band) {
  const float value =
      pl_input_is_set(in, k) ? in->value[k][band] : pl_regolith_inputs[k].fallback[band];
  return k == 1 ? fminf(fmaxf(value, -HIGH[k]), HIGH[k]) : pl_clipped(value, HIGH[k]);
}

/* Unset inputs keep the value of a surface that already has one. */
static void set(const pl_surface_inputs *in, size_t k, size_t band, float *out) {
  if (pl_input_is_set(in, k) || !in->had_regolith)
    *out = value_of(in, k, band);
}

void pl_regolith_set_phase(const pl_surface_inputs *in, pl_surface *surface) {
  if (!in->had_regolith)
    surface->regolith = (pl_regolith){0};
  for (size_t band = 0; band < 3; band++) {
    pl_regolith_band *out = &surface->regolith.band[band];
    set(in, 0, band, &out->b);
    set(in, 1, band, &out->c);
    set(in, 2, band, &out->b_s0);
    set(in, 3, band, &out->h_s);
  }
}

void pl_minnaert_set(const pl_surface_inputs *in, pl_surface *surface) {
  pl_regolith_set_phase(in, surface);
  const float *k = pl_input_is_set(in, LIMB) ? in->value[LIMB] : pl_minnaert_inputs[LIMB].fallback;
  if (pl_input_is_set(in, LIMB) || !in->had_regolith)
    surface->regolith.limb = pl_clipped(k[0], 2.0f) - 1.0f;
}

void pl_hapke_set_smooth(const pl_surface_inputs *in, pl_surface *surface) {
  pl_regolith_set_phase(in, surface);
  for (size_t band = 0; band < 3; band++) {
    pl_regolith_band *out = &surface->regolith.band[band];
    set(in, 4, band, &out->b_c0);
    set(in, 5, band, &out->h_c);
    set(in, 6, 0, &out->filling);
  }
}

void pl_hapke_set(const pl_surface_inputs *in, pl_surface *surface) {
  pl_hapke_set_smooth(in, surface);
  if (!pl_input_is_set(in, 7) && in->had_regolith)
    return;
  for (size_t band = 0; band < 3; band++)
    surface->regolith.band[band].roughness_rad = value_of(in, 7, 0) * (PL_PI_F / 180.0f);
}

bool pl_regolith_band_valid(const pl_regolith_band *band, bool partly) {
  const float low[] = {0.0f, -2.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f};
  const float high[] = {0.95f, 2.0f, 10.0f, 10.0f, 10.0f, 10.0f, 1.05f, 0.75f};
  const float *value = (const float *)band;
  for (size_t k = 0; k < PL_REGOLITH_VALUES; k++)
    if (isnan(value[k]) ? !partly : !(value[k] >= low[k] && value[k] <= high[k] * 1.000001f))
      return false;
  return true;
}

/* White grains at opposition reflect more than a white Lambertian surface: the bound is pi r there,
 * with H H below 9 and K below 4. */
void pl_regolith_summarise(const pl_surface_inputs *in, pl_model_summary *summary) {
  double high[PL_REGOLITH_PHASE_INPUTS];
  for (size_t k = 0; k < PL_REGOLITH_PHASE_INPUTS; k++) {
    const float *value = pl_input_is_set(in, k) ? in->value[k] : pl_regolith_inputs[k].fallback;
    high[k] = value == NULL ? (double)HIGH[k] : 0.0;
    for (size_t band = 0; value != NULL && band < 3; band++)
      high[k] = fmax(high[k], fabs((double)value[band]));
    high[k] = fmin(high[k], (double)HIGH[k]);
  }
  const double lobe = (1.0 + high[0]) / ((1.0 - high[0]) * (1.0 - high[0]));
  const double surges = (1.0 + high[2]) * (1.0 + high[1]) * lobe;
  summary->albedo_max = fmax(summary->albedo_max, 0.25 * surges + 2.0);
}
