/* The metallic-roughness surface of glTF 2.0, appendix B: a metal and a dielectric, mixed by
 * metalness. Both have a GGX microfacet lobe; that of the dielectric lies over a diffuse base,
 * which gets the light that the lobe transmits (ggx_fresnel.h). Energy that the metal's lobe loses
 * between microfacets is restored, partly as a second, broad lobe (ggx_loss.h); energy that the
 * dielectric's lobe loses goes to the base. */
#include "shade/ggx.h"
#include "shade/ggx_fresnel.h"
#include "shade/ggx_loss.h"
#include "shade/material_surface.h"
#include "shade/reflectance.h"

/* Terms for one outgoing direction, shared by evaluation, sampling and pdf. */
typedef struct view {
  float alpha, lambda; /* lambda: of the outgoing direction */
  pl_ggx_loss lost;    /* of the metal's lobe */
  pl_ggx_lost out;     /* multiple scattering towards wo; zero without metal */
  pl_ggx_glass glass;  /* of the dielectric; unset if all is metal */
  float entering;      /* light that the dielectric's lobe transmits to the base, towards wo */
  float chance;        /* probability of sampling the specular lobe */
} view;

/* Reflectance of the specular lobe at a cosine: Fresnel for the dielectric, Schlick for the metal.
 * `more`: relative increase of the metal's lobe by multiple reflections, whose colour is `further`.
 */
static pl_vec3f mirrored(const pl_surface *s, float cosine, float more, pl_vec3f further) {
  const float m = s->metallic;
  const float d = m < 1.0f ? (1.0f - m) * pl_fresnel(cosine, PL_DIELECTRIC_INDEX) : 0.0f;
  if (!(m > 0.0f))
    return pl_vec3f_make(d, d, d);
  const pl_vec3f metal = pl_schlick(s->color, 1.0f, cosine);
  return pl_vec3f_make(d + m * metal.x * (1.0f + more * further.x),
                       d + m * metal.y * (1.0f + more * further.y),
                       d + m * metal.z * (1.0f + more * further.z));
}

/* Broad lobe of the metal's multiple scattering without absorption, times cos(wi). */
static float broad(const view *v, const pl_surface *s, const pl_ggx_lost *in, float cos_i) {
  const float lost = v->out.broad * in->broad;
  return lost > 0.0f ? s->metallic * lost * cos_i / (PL_PI_F * v->lost.broad_mean) : 0.0f;
}

/* Probability of sampling the specular lobe: its part of the reflected light, limited to 0.1..0.9
 * where there is a diffuse base. The rest, base and multiple reflections, is sampled by the cosine.
 */
static float specular_chance(const view *v, const pl_surface *s, pl_vec3f wo) {
  const float m = s->metallic, color = pl_vec3f_max(s->color), base = (1.0f - m) * color;
  float specular = m < 1.0f ? (1.0f - m) * (1.0f - v->entering) : 0.0f;
  float broad = base * v->entering;
  if (m > 0.0f) {
    specular += m * (1.0f - v->out.broad) * pl_vec3f_max(pl_schlick(s->color, 1.0f, wo.z));
    broad += m * v->out.broad * pl_ggx_returned(color, v->lost.mean);
  }
  if (!(broad > 0.0f))
    return 1.0f;
  const float chance = specular / (specular + broad);
  return base > 0.0f ? pl_minf(pl_maxf(chance, 0.1f), 0.9f) : chance;
}

static view view_of(const pl_surface *s, pl_vec3f wo) {
  view v = {.alpha = pl_ggx_alpha(s->alpha)};
  v.lambda = pl_ggx_lambda(v.alpha, wo);
  const float roughness = sqrtf(v.alpha);
  if (s->metallic > 0.0f) {
    v.lost = pl_ggx_loss_of(roughness);
    v.out = pl_ggx_lost_at(&v.lost, wo.z);
  }
  if (s->metallic < 1.0f) {
    v.glass = pl_ggx_glass_of(roughness);
    v.entering = 1.0f - pl_ggx_glass_albedo(&v.glass, wo.z);
  }
  v.chance = specular_chance(&v, s, wo);
  return v;
}

/* Factor of the diffuse base relative to a white Lambertian surface. The sample implementation of
 * glTF has 1 - F(wo.h), with which a smooth white dielectric reflects up to twice the incident
 * light. */
static float base_fraction(const view *v, const pl_surface *s, float cos_i) {
  if (!(s->metallic < 1.0f))
    return 0.0f;
  const float in = 1.0f - pl_ggx_glass_albedo(&v->glass, cos_i);
  return (1.0f - s->metallic) * pl_ggx_base_share(v->entering, in, 1.0f - v->glass.mean);
}

/* BRDF times cos(wi); h is the half vector. Both directions are above the horizon. */
static pl_vec3f value_of(const view *v, const pl_surface *s, pl_vec3f wo, pl_vec3f wi, pl_vec3f h) {
  pl_ggx_lost in = {0.0f, 1.0f};
  pl_vec3f further = {0.0f, 0.0f, 0.0f};
  float more = 0.0f;
  if (s->metallic > 0.0f) {
    in = pl_ggx_lost_at(&v->lost, wi.z);
    more = v->out.gain * in.gain - 1.0f;
    further = pl_ggx_further_of(s->color, v->lost.mean);
  }
  const pl_vec3f f = mirrored(s, pl_vec3f_dot(wo, h), more, further);
  /* Height-correlated Smith (Heitz 2014, eq. 99); cos(wi) cancels one of the two cosines. */
  const float g = 1.0f / (1.0f + v->lambda + pl_ggx_lambda(v->alpha, wi));
  const float specular =
      pl_ggx_density(v->alpha, v->alpha, h) * g / (4.0f * pl_maxf(wo.z, PL_GGX_COSINE_MIN));
  const float base = base_fraction(v, s, wi.z) * wi.z / PL_PI_F;
  const float again = broad(v, s, &in, wi.z);
  const pl_vec3f c = s->color;
  return pl_vec3f_make(
      f.x * specular + again * pl_ggx_reflectance_mean(c.x) * further.x + base * c.x,
      f.y * specular + again * pl_ggx_reflectance_mean(c.y) * further.y + base * c.y,
      f.z * specular + again * pl_ggx_reflectance_mean(c.z) * further.z + base * c.z);
}

/* Density of wi: by visible normals (Heitz 2018, eq. 17), or by the cosine. */
static float density_of(const view *v, pl_vec3f wo, pl_vec3f wi, pl_vec3f h) {
  const float specular = pl_ggx_density(v->alpha, v->alpha, h) /
                         (4.0f * pl_maxf(wo.z, PL_GGX_COSINE_MIN) * (1.0f + v->lambda));
  return v->chance * specular + (1.0f - v->chance) * pl_cosine_hemisphere_pdf(wi.z);
}

static pl_vec3f evaluate(const pl_surface *s, pl_vec3f wo, pl_vec3f wi) {
  if (!(wi.z > 0.0f) || !(wo.z > 0.0f))
    return pl_vec3f_make(0.0f, 0.0f, 0.0f);
  const view v = view_of(s, wo);
  return value_of(&v, s, wo, wi, pl_vec3f_unit(pl_vec3f_add(wo, wi)));
}

static float pdf(const pl_surface *s, pl_vec3f wo, pl_vec3f wi) {
  if (!(wi.z > 0.0f) || !(wo.z > 0.0f))
    return 0.0f;
  const view v = view_of(s, wo);
  return density_of(&v, wo, wi, pl_vec3f_unit(pl_vec3f_add(wo, wi)));
}

static float pdf_most(const pl_surface *s, pl_vec3f wo) {
  const view v = view_of(s, wo);
  return v.chance * pl_ggx_pdf_most(v.alpha) + (1.0f - v.chance) * pl_cosine_hemisphere_pdf(1.0f);
}

static bool sample(const pl_surface *s, pl_vec3f wo, const float u[2], pl_vec3f *wi,
                   pl_vec3f *weight, float *density) {
  if (!(wo.z > 0.0f))
    return false;
  const view v = view_of(s, wo);
  float r[2] = {u[0], u[1]};
  if (pl_sample_choose(v.chance, &r[0])) {
    const pl_vec3f normal = pl_ggx_visible_normal(v.alpha, v.alpha, wo, r);
    *wi = pl_vec3f_sub(pl_vec3f_scale(normal, 2.0f * pl_vec3f_dot(wo, normal)), wo);
  } else {
    *wi = pl_sample_cosine_hemisphere(r[0], r[1]);
  }
  if (!(wi->z > 0.0f))
    return false;
  const pl_vec3f h = pl_vec3f_unit(pl_vec3f_add(wo, *wi));
  *density = density_of(&v, wo, *wi, h);
  if (!(*density > 0.0f))
    return false;
  *weight = pl_vec3f_scale(value_of(&v, s, wo, *wi, h), 1.0f / *density);
  return true;
}

/* --- as a node of material graphs ------------------------------------------------------------- */

enum { METALLIC, ROUGHNESS };

static const pl_socket inputs[] = {
    [METALLIC] = {"metallic", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "0..1"},
    [ROUGHNESS] = {"roughness", PL_SCALAR, {0.5f, 0.5f, 0.5f}, "0..1; GGX alpha is its square"},
};

static void set(const pl_surface_inputs *in, pl_surface *surface) {
  if (pl_input_is_set(in, METALLIC))
    surface->metallic = pl_clipped(in->value[METALLIC][0], 1.0f);
  if (pl_input_is_set(in, ROUGHNESS)) {
    const float roughness = pl_clipped(in->value[ROUGHNESS][0], 1.0f);
    surface->alpha = roughness * roughness;
  }
}

static void summarise(const pl_surface_inputs *in, pl_model_summary *summary) {
  if (!pl_input_is_set(in, ROUGHNESS))
    return;
  const float *known = in->value[ROUGHNESS];
  const double roughness = known != NULL ? (double)pl_clipped(known[0], 1.0f) : 0.0;
  summary->ggx_alpha_min = fmin(summary->ggx_alpha_min, roughness * roughness);
}

const pl_reflectance pl_reflectance_metallic_roughness = {
    .name = "metallic_roughness",
    .doc = "glTF 2.0 metallic-roughness: GGX (Smith, Fresnel, multiple reflection) over a diffuse "
           "base, with no light lost",
    .evaluate = evaluate,
    .pdf = pdf,
    .pdf_most = pdf_most,
    .sample = sample,
    .inputs = inputs,
    .input_count = sizeof inputs / sizeof inputs[0],
    .set = set,
    .summarise = summarise,
};
