/* Reflectance of open water. Only single reflection: light that goes from wave to wave is at most a
 * few thousandths. */
#include "shade/water.h"

#include "math/sampling.h"
#include "shade/ggx.h"
#include "shade/refraction.h"

static const float INDEX = 1.34f;
/* Transmittance of smooth water for uniform diffuse light (Preisendorfer 1976, Hydrologic Optics
 * VI: reflectance 0.066). */
static const float EVEN_SHARE = 0.934f;

/* Smith's Lambda for Gaussian slopes (Heitz 2014, eq. 64). */
static float lambda(float alpha, float cosine) {
  const float c = pl_maxf(cosine, PL_GGX_COSINE_MIN);
  const float a = c / (alpha * sqrtf(pl_maxf(1.0f - c * c, 1e-12f)));
  if (a > 4.0f)
    return 0.0f;
  return 0.5f * (expf(-a * a) / (a * sqrtf(PL_PI_F)) - erfcf(a));
}

/* Density of microfacet normals (Heitz 2014, eq. 60); h is unit, h.z > 0. */
static float density(float alpha, pl_vec3f h) {
  const float c2 = h.z * h.z, a2 = alpha * alpha;
  if (c2 < 1e-10f) /* opposite directions at the horizon */
    return 0.0f;
  return expf(-(h.x * h.x + h.y * h.y) / (a2 * c2)) / (PL_PI_F * a2 * c2 * c2);
}

static float mirrored(const pl_surface *s, pl_vec3f wo, pl_vec3f wi, pl_vec3f h) {
  const float alpha = pl_ggx_alpha(s->alpha);
  const float seen = 1.0f / (1.0f + lambda(alpha, wo.z) + lambda(alpha, wi.z));
  return pl_fresnel(pl_vec3f_dot(wo, h), INDEX) * density(alpha, h) * seen /
         (4.0f * pl_maxf(wo.z, PL_GGX_COSINE_MIN));
}

/* Adds the reflection by waves to the colour and subtracts the light that they keep from the water
 * below. */
static pl_vec3f over_base(const pl_surface *s, float glint, float kept, float scale) {
  return pl_vec3f_make(glint + scale * (s->color.x - kept * s->below.x),
                       glint + scale * (s->color.y - kept * s->below.y),
                       glint + scale * (s->color.z - kept * s->below.z));
}

static pl_vec3f value_of(const pl_surface *s, pl_vec3f wo, pl_vec3f wi, pl_vec3f h) {
  const float through = (1.0f - pl_fresnel(wo.z, INDEX)) * (1.0f - pl_fresnel(wi.z, INDEX));
  return over_base(s, s->water * mirrored(s, wo, wi, h), 1.0f - through, wi.z / PL_PI_F);
}

/* Probability of sampling the lobe, which uses GGX's visible normals of the same alpha: their
 * density is more than half that of the waves everywhere, and their tails are longer. */
static float glint_chance(const pl_surface *s, pl_vec3f wo) {
  const float glint = s->water * pl_fresnel(wo.z, INDEX);
  const float base = pl_vec3f_max(s->color);
  return base > 0.0f ? pl_minf(pl_maxf(glint / (glint + base), 0.1f), 0.9f) : 1.0f;
}

static float density_of(const pl_surface *s, pl_vec3f wo, pl_vec3f wi, pl_vec3f h) {
  const float alpha = pl_ggx_alpha(s->alpha), chance = glint_chance(s, wo);
  const float lobe = pl_ggx_density(alpha, alpha, h) /
                     (4.0f * pl_maxf(wo.z, PL_GGX_COSINE_MIN) * (1.0f + pl_ggx_lambda(alpha, wo)));
  return chance * lobe + (1.0f - chance) * pl_cosine_hemisphere_pdf(wi.z);
}

static pl_vec3f evaluate(const pl_surface *s, pl_vec3f wo, pl_vec3f wi) {
  if (!(wi.z > 0.0f) || !(wo.z > 0.0f))
    return pl_vec3f_make(0.0f, 0.0f, 0.0f);
  return value_of(s, wo, wi, pl_vec3f_unit(pl_vec3f_add(wo, wi)));
}

static float pdf(const pl_surface *s, pl_vec3f wo, pl_vec3f wi) {
  if (!(wi.z > 0.0f) || !(wo.z > 0.0f))
    return 0.0f;
  return density_of(s, wo, wi, pl_vec3f_unit(pl_vec3f_add(wo, wi)));
}

static bool sample(const pl_surface *s, pl_vec3f wo, const float u[2], pl_vec3f *wi,
                   pl_vec3f *weight, float *out) {
  if (!(wo.z > 0.0f))
    return false;
  float r[2] = {u[0], u[1]};
  if (pl_sample_choose(glint_chance(s, wo), &r[0])) {
    const float alpha = pl_ggx_alpha(s->alpha);
    const pl_vec3f normal = pl_ggx_visible_normal(alpha, alpha, wo, r);
    *wi = pl_vec3f_sub(pl_vec3f_scale(normal, 2.0f * pl_vec3f_dot(wo, normal)), wo);
  } else {
    *wi = pl_sample_cosine_hemisphere(r[0], r[1]);
  }
  if (!(wi->z > 0.0f))
    return false;
  const pl_vec3f h = pl_vec3f_unit(pl_vec3f_add(wo, *wi));
  *out = density_of(s, wo, *wi, h);
  if (!(*out > 0.0f))
    return false;
  *weight = pl_vec3f_scale(value_of(s, wo, *wi, h), 1.0f / *out);
  return true;
}

/* Reflectance of waves under a uniform sky: Fresnel's law at a cosine that grows with their slopes.
 * Fitted to the integral, within 0.1 of it for every wind and angle (tests/c/test_water.c). */
static pl_vec3f under_sky(const pl_surface *s, pl_vec3f wo) {
  const float alpha = pl_ggx_alpha(s->alpha), c2 = wo.z * wo.z;
  const float glint = pl_fresnel(sqrtf(c2 + 0.9f * alpha * alpha * (1.0f - c2)), INDEX);
  const float through = (1.0f - pl_fresnel(wo.z, INDEX)) * EVEN_SHARE;
  return over_base(s, s->water * glint, 1.0f - through, 1.0f);
}

const pl_reflectance pl_reflectance_water = {
    .name = "water",
    .doc = "Open water over Lambert ground: Gaussian waves, Fresnel for 1.34",
    .evaluate = evaluate,
    .pdf = pdf,
    .sample = sample,
    .under_sky = under_sky,
};
