/* The metallic-roughness surface of glTF 2.0, appendix B: a GGX microfacet lobe over a diffuse
 * base, mixed by metalness. Light that the lobe loses between microfacets comes back as a second,
 * broad lobe (Kulla and Conty, "Revisiting Physically Based Shading at Imageworks", 2017). */
#include "shade/ggx.h"
#include "shade/ggx_loss.h"
#include "shade/material_surface.h"
#include "shade/reflectance.h"

static pl_vec3f f0_of(const pl_surface *s) {
  const float m = s->metallic, d = PL_DIELECTRIC_F0 * (1.0f - m);
  return pl_vec3f_make(d + m * s->color.x, d + m * s->color.y, d + m * s->color.z);
}

static pl_vec3f fresnel(pl_vec3f f0, float cosine) { return pl_schlick(f0, 1.0f, cosine); }

/* What evaluating, drawing and densities share for one outgoing direction. */
typedef struct view {
  pl_vec3f f0;
  float alpha, lambda; /* of the outgoing direction */
  float roughness;
  float loss, loss_mean; /* of metals; 0 otherwise */
  float chance;          /* of drawing the specular lobe */
} view;

/* Multiply reflected light times cos(wi). Zero where the lobe is so sharp that it loses nothing,
 * and for dielectrics, which return less than 0.005 of the light so: most surfaces are spared the
 * cost.
 */
static pl_vec3f multiple(const view *v, float cos_i) {
  const float lost = v->loss > 0.0f ? v->loss * pl_ggx_loss(v->roughness, cos_i) : 0.0f;
  if (!(lost > 0.0f))
    return pl_vec3f_make(0.0f, 0.0f, 0.0f);
  const float scale = lost * cos_i / (PL_PI_F * v->loss_mean);
  return pl_vec3f_make(scale * pl_ggx_returned(v->f0.x, v->loss_mean),
                       scale * pl_ggx_returned(v->f0.y, v->loss_mean),
                       scale * pl_ggx_returned(v->f0.z, v->loss_mean));
}

/* Chance of drawing the specular lobe: its share of the reflected light, kept off 0 and 1 where
 * there is a diffuse base. The rest, base and multiple reflections, is drawn by the cosine. */
static float specular_chance(const view *v, const pl_surface *s, pl_vec3f wo) {
  const float specular = pl_vec3f_max(fresnel(v->f0, wo.z));
  const float base = (1.0f - s->metallic) * pl_vec3f_max(s->color);
  const float broad = base + v->loss * pl_ggx_returned(pl_vec3f_max(v->f0), v->loss_mean);
  if (!(broad > 0.0f))
    return 1.0f;
  const float chance = specular / (specular + broad);
  return base > 0.0f ? pl_minf(pl_maxf(chance, 0.1f), 0.9f) : chance;
}

static view view_of(const pl_surface *s, pl_vec3f wo) {
  view v = {.f0 = f0_of(s), .alpha = pl_ggx_alpha(s->alpha)};
  v.lambda = pl_ggx_lambda(v.alpha, wo);
  if (s->metallic > 0.0f) {
    v.roughness = sqrtf(v.alpha);
    v.loss = pl_ggx_loss(v.roughness, wo.z);
    v.loss_mean = pl_ggx_loss_mean(v.roughness);
  }
  v.chance = specular_chance(&v, s, wo);
  return v;
}

/* The share of light that enters the base and leaves it again: what the coat would mirror at the
 * more grazing of the two directions is missing. glTF's sample implementation has 1 - F(wo.h), with
 * which a smooth white dielectric reflects up to twice the light that it gets. */
static pl_vec3f base_share(pl_vec3f f0, pl_vec3f wo, pl_vec3f wi) {
  const pl_vec3f f = fresnel(f0, pl_minf(wo.z, wi.z));
  return pl_vec3f_make(1.0f - f.x, 1.0f - f.y, 1.0f - f.z);
}

/* BRDF times cos(wi); h is the half vector. Both directions are over the horizon. */
static pl_vec3f value_of(const view *v, const pl_surface *s, pl_vec3f wo, pl_vec3f wi, pl_vec3f h) {
  const pl_vec3f base = base_share(v->f0, wo, wi);
  const pl_vec3f f = fresnel(v->f0, pl_vec3f_dot(wo, h));
  /* Height-correlated Smith (Heitz 2014, eq. 99); cos(wi) cancels one of the two cosines. */
  const float g = 1.0f / (1.0f + v->lambda + pl_ggx_lambda(v->alpha, wi));
  const float specular =
      pl_ggx_density(v->alpha, v->alpha, h) * g / (4.0f * pl_maxf(wo.z, PL_GGX_COSINE_MIN));
  const float diffuse = (1.0f - s->metallic) * wi.z / PL_PI_F;
  const pl_vec3f again = multiple(v, wi.z);
  return pl_vec3f_make(f.x * specular + again.x + base.x * diffuse * s->color.x,
                       f.y * specular + again.y + base.y * diffuse * s->color.y,
                       f.z * specular + again.z + base.z * diffuse * s->color.z);
}

/* Density of wi: from visible normals (Heitz 2018, eq. 17), or by the cosine. */
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

static bool sample(const pl_surface *s, pl_vec3f wo, const float u[2], float choice, pl_vec3f *wi,
                   pl_vec3f *weight, float *density) {
  if (!(wo.z > 0.0f))
    return false;
  const view v = view_of(s, wo);
  if (choice < v.chance) {
    const pl_vec3f normal = pl_ggx_visible_normal(v.alpha, v.alpha, wo, u);
    *wi = pl_vec3f_sub(pl_vec3f_scale(normal, 2.0f * pl_vec3f_dot(wo, normal)), wo);
  } else {
    *wi = pl_sample_cosine_hemisphere(u[0], u[1]);
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

/* --- as a node of material graphs ---------------------------------------------------------------
 */

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
    .doc = "glTF 2.0 metallic-roughness: GGX (Smith, Schlick, multiple reflection) over a diffuse "
           "base",
    .evaluate = evaluate,
    .pdf = pdf,
    .pdf_most = pdf_most,
    .sample = sample,
    .inputs = inputs,
    .input_count = sizeof inputs / sizeof inputs[0],
    .set = set,
    .summarise = summarise,
};
