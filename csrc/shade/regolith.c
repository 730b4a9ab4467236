/* Shared by the photometric models: evaluation per band and sampling. */
#include "shade/regolith.h"

#include <string.h>

#include "math/sampling.h"
#include "shade/rough.h"
#include "shade/regolith_law.h"

static pl_hapke band_of(const pl_surface *surface, int k) {
  const float w[3] = {surface->color.x, surface->color.y, surface->color.z};
  const pl_regolith_band *band = &surface->regolith.band[k];
  return (pl_hapke){
      .w = (double)w[k],
      .b = (double)band->b,
      .c = (double)band->c,
      .b_s0 = (double)band->b_s0,
      .h_s = (double)band->h_s,
      .b_c0 = (double)band->b_c0,
      .h_c = (double)band->h_c,
      .roughness_rad = (double)band->roughness_rad,
      .filling = (double)band->filling,
      .simple_h = surface->regolith.simple_h,
      .narrow_surge = surface->regolith.narrow_surge,
  };
}

/* True for bands that differ in the albedo alone. */
static bool alike(const pl_hapke *a, const pl_hapke *b) {
  return a->b == b->b && a->c == b->c && a->b_s0 == b->b_s0 && a->h_s == b->h_s &&
         a->b_c0 == b->b_c0 && a->h_c == b->h_c && a->roughness_rad == b->roughness_rad &&
         a->filling == b->filling;
}

/* `phases`: of the three bands, for light and a viewer at one angle to each other. */
static pl_vec3f evaluate_plane(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi,
                               pl_regolith_law law, pl_regolith_phase phases[3]) {
  double value[3];
  pl_hapke last = {0};
  if (!(wi.z > 0.0f && wo.z > 0.0f))
    return pl_vec3f_make(0.0f, 0.0f, 0.0f);
  const pl_hapke_angles angles = pl_hapke_angles_of(pl_vec3_unit(pl_vec3f_to_double(wi)),
                                                    pl_vec3_unit(pl_vec3f_to_double(wo)));
  pl_regolith_shared shared = {.known = false, .roughness_rad = -1.0};
  for (int k = 0; k < 3; k++) {
    const pl_hapke band = band_of(surface, k);
    const bool known = k > 0 && alike(&band, &last);
    shared.known = shared.known && known;
    shared.phase = &phases[k];
    value[k] = known && band.w == last.w
                   ? value[k - 1]
                   : law(&band, (double)surface->regolith.limb, &angles, &shared);
    last = band;
  }
  for (int k = 0; k < 3; k++)
    value[k] *= 1.0 + (double)surface->regolith.excess[k];
  return pl_vec3f_make((float)value[0], (float)value[1], (float)value[2]);
}

/* A law as the context of a function, with what facets share. */
typedef struct plane {
  pl_regolith_law law;
  pl_regolith_phase *phases;
} plane;

static pl_vec3f facet(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi, const void *context) {
  const plane *of = context;
  return evaluate_plane(surface, wo, wi, of->law, of->phases);
}

pl_vec3f pl_regolith_evaluate(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi,
                              pl_regolith_law law) {
  pl_regolith_phase phases[3] = {{.known = false}};
  const plane of = {law, phases};
  return pl_rough_on(&surface->rough) ? pl_rough_reflect(surface, wo, wi, facet, &of)
                                      : evaluate_plane(surface, wo, wi, law, phases);
}

/* Probability of sampling the backscattering lobe, and its Henyey-Greenstein parameter. */
static const float BACK = 0.2f, BACK_B = 0.4f;

/* Part of the other samples that is uniform over the hemisphere; the rest is cosine-weighted. */
static float flat_part(pl_vec3f wo) { return pl_minf(pl_maxf(1.0f - wo.z, 0.0f), 1.0f); }

static float back_pdf(pl_vec3f wo, pl_vec3f wi) {
  const pl_vec3f apart = pl_vec3f_sub(wo, wi);
  const float d = (1.0f - BACK_B) * (1.0f - BACK_B) + BACK_B * pl_vec3f_dot(apart, apart);
  return (1.0f - BACK_B * BACK_B) / (4.0f * PL_PI_F * d * sqrtf(d));
}

/* Inversion of the Henyey-Greenstein function (1941). */
static pl_vec3f sample_back(pl_vec3f wo, const float u[2]) {
  const float s = (1.0f - BACK_B * BACK_B) / (1.0f - BACK_B + 2.0f * BACK_B * u[0]);
  const float z = (1.0f + BACK_B * BACK_B - s * s) / (2.0f * BACK_B);
  const float r = sqrtf(pl_maxf(1.0f - z * z, 0.0f)), turn = 2.0f * PL_PI_F * u[1];
  const pl_basis basis = pl_basis_make(wo);
  return pl_basis_to_world(&basis, pl_vec3f_make(r * cosf(turn), r * sinf(turn), z));
}

float pl_regolith_pdf(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi) {
  (void)surface;
  if (!(wi.z > 0.0f))
    return 0.0f;
  const float flat = flat_part(wo);
  const float rest = flat * (0.5f / PL_PI_F) + (1.0f - flat) * pl_cosine_hemisphere_pdf(wi.z);
  return BACK * back_pdf(wo, wi) + (1.0f - BACK) * rest;
}

bool pl_regolith_sample(const pl_surface *surface, pl_vec3f wo, const float u[2],
                        pl_regolith_law law, pl_vec3f *wi, pl_vec3f *weight, float *pdf) {
  float r[2] = {u[0], u[1]};
  if (pl_sample_choose(BACK, &r[0]))
    *wi = sample_back(wo, r);
  else if (pl_sample_choose(flat_part(wo), &r[0]))
    *wi = pl_sample_cone(r[0], r[1], 1.0f);
  else
    *wi = pl_sample_cosine_hemisphere(r[0], r[1]);
  *pdf = pl_regolith_pdf(surface, wo, *wi);
  if (!(*pdf > 0.0f))
    return false;
  pl_regolith_phase phases[3] = {{.known = false}};
  *weight = pl_vec3f_scale(evaluate_plane(surface, wo, *wi, law, phases), 1.0f / *pdf);
  return true;
}

double pl_regolith_single(const pl_hapke *band, const pl_hapke_angles *angles) {
  return (1.0 + band->b_s0 * pl_hapke_shadow_surge(band, angles)) * pl_hapke_phase(band, angles);
}

double pl_regolith_fall(const pl_hapke *band, const pl_hapke_angles *angles) {
  const pl_hapke_angles opposition = {.half_cosine2 = 1.0};
  const double full = pl_regolith_single(band, &opposition);
  return full > 0.0 ? pl_regolith_single(band, angles) / full : 0.0;
}

double pl_regolith_peak(const pl_surface *surface) {
  enum { SLANTS = 11, AZIMUTHS = 7 };
  static const float slants[SLANTS] = {0, 20, 40, 55, 65, 75, 80, 84, 87, 89, 89.9f};
  static const float azimuths[AZIMUTHS] = {0, 4, 10, 20, 45, 90, 180};
  const float degree = PL_PI_F / 180.0f;
  float peak = 0.0f;
  for (int i = 0; i < SLANTS; i++)
    for (int e = 0; e < SLANTS; e++)
      for (int a = 0; a < AZIMUTHS; a++) {
        const float x = slants[i] * degree, y = slants[e] * degree, turn = azimuths[a] * degree;
        const pl_vec3f wi = {sinf(x), 0.0f, cosf(x)};
        const pl_vec3f wo = {sinf(y) * cosf(turn), sinf(y) * sinf(turn), cosf(y)};
        peak = pl_maxf(peak, pl_vec3f_max(surface->reflectance->evaluate(surface, wo, wi)));
      }
  return 1.1 * PL_PI * (double)peak;
}

void pl_regolith_band_take(const pl_regolith_band *given, pl_regolith_band *out) {
  const float *from = (const float *)given;
  float *to = (float *)out;
  for (size_t k = 0; k < PL_REGOLITH_VALUES; k++)
    if (!isnan(from[k]))
      to[k] = from[k];
}
