/* The principled surface: the metallic-roughness base with anisotropy, index of refraction and
 * specular tint, transmission through thin walls or boundaries of solids, and a clear coat. */
#include "shade/ggx.h"
#include "shade/ggx_fresnel.h"
#include "shade/ggx_loss.h"
#include "shade/ggx_loss_xy.h"
#include "shade/principled_inputs.h"
#include "shade/reflectance.h"
#include "shade/refraction.h"

/* Minimum sampling probability of a lobe that is present. */
static const float CHANCE_MIN = 0.1f;

/* Lobes that a sample can choose. Reflection: the coat, the specular lobe of the base, and the
 * broad rest (diffuse, multiple scattering). Transmission: the specular lobe, and its broad rest.
 */
enum { COAT, MIRROR, BROAD, THROUGH, THROUGH_BROAD, CHOICES };

typedef struct lobe {
  float ax, ay;
  float lambda; /* of the outgoing direction */
  bool even;    /* isotropic: both alphas are equal */
} lobe;

/* Energy loss of a lobe by single scattering. */
typedef struct loss {
  bool even;
  union {
    pl_ggx_loss one;
    pl_ggx_loss_xy xy;
  };
  float mean, broad_mean;
} loss;

/* Terms for one outgoing direction, shared by evaluation, sampling and pdf. */
typedef struct view {
  lobe base, coat;
  bool coat_bent; /* the coat has its own normal */
  pl_basis coat_basis;
  float eta; /* of a solid: index behind the surface over that before it; 0: a thin wall */
  /* Weights; the latter two: parts of the light that enters the base. */
  float coat_weight, diffuse, through;
  pl_ggx_glass coat_table;
  float coat_out; /* transmittance of the coat towards wo, for uniform incident light */
  /* Isotropic lobes: of all directions; anisotropic lobes: for wo only. */
  pl_ggx_dielectric base_table;
  pl_ggx_albedo base_out; /* albedo of the base's lobe towards wo */
  pl_vec3f f0;            /* of the dielectric */
  float f90, index;
  loss lost;       /* of the base's lobe */
  bool gives_back; /* true for metals and thin walls: lost energy is restored */
  pl_ggx_lost out; /* multiple scattering towards wo; gain 1 without it */
  float chance[CHOICES];
} view;

static lobe lobe_of(float ax, float ay, pl_vec3f wo) {
  return (lobe){ax, ay, pl_ggx_lambda_xy(ax, ay, wo), !(ax > ay)};
}

/* Single scattering by a lobe with a reflectance of 1, times cos(wi); height-correlated Smith
 * (Heitz 2014, eq. 99). */
static float mirrored(const lobe *l, pl_vec3f wo, pl_vec3f wi, pl_vec3f h) {
  const float g = 1.0f / (1.0f + l->lambda + pl_ggx_lambda_xy(l->ax, l->ay, wi));
  return pl_ggx_density(l->ax, l->ay, h) * g / (4.0f * pl_maxf(wo.z, PL_GGX_COSINE_MIN));
}

/* Density of wi when sampled by visible normals (Heitz 2018, eq. 17). */
static float mirrored_pdf(const lobe *l, pl_vec3f wo, pl_vec3f h) {
  return pl_ggx_density(l->ax, l->ay, h) /
         (4.0f * pl_maxf(wo.z, PL_GGX_COSINE_MIN) * (1.0f + l->lambda));
}

static loss loss_of(const lobe *l) {
  loss out = {.even = l->even};
  if (l->even) {
    out.one = pl_ggx_loss_of(sqrtf(l->ay));
    out.mean = out.one.mean;
    out.broad_mean = out.one.broad_mean;
  } else {
    out.xy = pl_ggx_loss_xy_of(l->ax, l->ay);
    out.mean = out.xy.mean;
    out.broad_mean = out.xy.broad_mean;
  }
  return out;
}

static pl_ggx_lost lost_towards(const loss *l, pl_vec3f w) {
  return l->even ? pl_ggx_lost_at(&l->one, fabsf(w.z)) : pl_ggx_lost_xy_at(&l->xy, w);
}

/* Transforms a direction from the surface's frame to the coat's. */
static pl_vec3f of_coat(const view *v, pl_vec3f w) {
  return v->coat_bent ? pl_basis_to_local(&v->coat_basis, w) : w;
}

/* Sets the coat's frame. A normal that faces away from the viewer is turned to grazing incidence.
 */
static void set_coat_basis(view *v, const pl_surface *s, pl_vec3f wo) {
  const pl_vec3f n = pl_surface_to_local(s, s->lobes.coat_normal);
  const float least = 1e-3f, cosine = pl_vec3f_dot(n, wo);
  v->coat_bent = pl_vec3f_dot(n, n) > 0.5f;
  if (v->coat_bent)
    v->coat_basis = pl_basis_make(
        cosine < least ? pl_vec3f_unit(pl_vec3f_madd(n, least - cosine, wo)) : pl_vec3f_unit(n));
}

/* Coats have an index of 1.5 (KHR_materials_clearcoat). */
static float coat_fresnel(const view *v, float cosine) {
  return v->coat_weight > 0.0f ? v->coat_weight * pl_fresnel(cosine, PL_DIELECTRIC_INDEX) : 0.0f;
}

/* Reflectance of the dielectric at a cosine; 1 for a solid in total internal reflection. */
static pl_vec3f dielectric_of(const view *v, float cosine) {
  if (v->eta > 0.0f) {
    const float f = pl_fresnel(cosine, v->eta);
    return pl_vec3f_make(f, f, f);
  }
  const float rise = pl_fresnel_rise(cosine, v->index);
  return pl_vec3f_make(pl_maxf(v->f0.x + (v->f90 - v->f0.x) * rise, 0.0f),
                       pl_maxf(v->f0.y + (v->f90 - v->f0.y) * rise, 0.0f),
                       pl_maxf(v->f0.z + (v->f90 - v->f0.z) * rise, 0.0f));
}

/* Reflectance of the base's specular lobe: dielectric and metal (Schlick), mixed by metalness.
 * `more`: relative increase of the lobe by multiple reflections, for metals and thin walls;
 * `further`: colour of those reflections on metal. */
static pl_vec3f mirror_of(const view *v, const pl_surface *s, float cosine, float more,
                          pl_vec3f further) {
  const float m = s->metallic;
  const float wall = v->eta > 0.0f ? 0.0f : v->through, d = 1.0f - m + more * wall;
  if (!(m > 0.0f))
    return pl_vec3f_scale(dielectric_of(v, cosine), d);
  const pl_vec3f once = pl_schlick(s->color, 1.0f, cosine);
  const pl_vec3f metal = {m * once.x * (1.0f + more * further.x),
                          m * once.y * (1.0f + more * further.y),
                          m * once.z * (1.0f + more * further.z)};
  return m < 1.0f ? pl_vec3f_madd(metal, d, dielectric_of(v, cosine)) : metal;
}

/* Ratio of indices at the boundary of a solid; 0 without transmission, and for an index near that
 * of vacuum, which has no visible boundary. */
static float eta_of(const pl_lobes *l) {
  if (!(l->ior > 0.0f && l->transmission > 0.0f) || fabsf(l->ior - 1.0f) < 1e-3f)
    return 0.0f;
  return l->inside ? 1.0f / l->ior : l->ior;
}

/* --- transmission into the layers ------------------------------------------------------------- */

/* An anisotropic lobe is assumed to reflect `rise` like the isotropic one of the same width along
 * the direction. This is too much where facets are tilted sideways: the base is then too dark,
 * across lobes of anisotropy 0.6 at 85 degrees by up to 0.04 of the light, of 1 by up to 0.25.
 * Nowhere is it too bright by more than 0.005. */
static pl_ggx_dielectric along(const lobe *l, float x2, float y2, float index) {
  const float alpha2 = (l->ax * l->ax * x2 + l->ay * l->ay * y2) / (x2 + y2);
  return pl_ggx_dielectric_rise(sqrtf(sqrtf(alpha2)), index);
}

static pl_ggx_dielectric table_of(const lobe *l, pl_vec3f w, float index) {
  return l->even ? pl_ggx_dielectric_of(sqrtf(l->ay), index)
                 : along(l, w.x * w.x + 1e-12f, w.y * w.y + 1e-12f, index);
}

/* `d`: table of the base's lobe for w. */
static pl_ggx_albedo albedo_of(const view *v, const pl_ggx_dielectric *d, pl_vec3f w) {
  if (v->base.even)
    return pl_ggx_albedo_of(d, w.z);
  return (pl_ggx_albedo){1.0f - pl_ggx_loss_xy_at(&v->lost.xy, w), pl_ggx_rise(d, w.z)};
}

enum { TURNS = 4 }; /* number of azimuths of a quadrant over which anisotropic lobes are averaged */
/* Squared sines of these azimuths: pi/16, 3 pi/16 and so on. */
static const float SINE2[TURNS] = {0.03806023f, 0.30865828f, 0.69134172f, 0.96193977f};

/* Cosine-weighted mean of the albedos over the hemisphere, and the deviation of `rise`. */
static pl_ggx_albedo mean_of(const view *v, float *deviation) {
  *deviation = v->base_table.deviation;
  if (v->base.even)
    return v->base_table.mean;
  pl_ggx_albedo mean = {1.0f - v->lost.mean, 0.0f};
  *deviation = 0.0f;
  for (int i = 0; i < TURNS; i++) {
    const float sine2 = SINE2[i];
    const pl_ggx_dielectric d = along(&v->base, 1.0f - sine2, sine2, v->index);
    mean.rise += d.mean.rise / TURNS;
    *deviation += d.deviation / TURNS;
  }
  return mean;
}

static float passes_coat(const view *v, pl_vec3f w) {
  return 1.0f - v->coat_weight * pl_ggx_glass_albedo(&v->coat_table, fabsf(of_coat(v, w).z));
}

/* Sets the terms of the coat and of the dielectric, if present. Boundaries of solids seen from
 * inside have no albedo table. */
static void set_layers(view *v, const pl_surface *s, pl_vec3f wo) {
  v->f0 = s->lobes.f0;
  v->f90 = s->lobes.f90;
  v->index = s->lobes.index;
  v->coat_out = 1.0f;
  if (v->eta > 0.0f) {
    const float f = pl_fresnel(1.0f, v->eta);
    v->f0 = pl_vec3f_make(f, f, f);
    v->f90 = 1.0f;
    v->index = v->eta;
  }
  if (v->coat_weight > 0.0f) {
    v->coat_table = pl_ggx_glass_of(sqrtf(v->coat.ax));
    v->coat_out = passes_coat(v, wo);
  }
  if (v->diffuse > 0.0f || v->through > 0.0f) {
    v->base_table = table_of(&v->base, wo, v->index);
    v->base_out = albedo_of(v, &v->base_table, wo);
  }
}

/* Reflectance of the dielectric's lobe towards wo. Solids without a diffuse part or seen from
 * inside are treated as smooth. */
static float mirrored_part(const view *v, const pl_surface *s, float cosine) {
  if (v->eta > 0.0f && (s->lobes.inside || !(v->diffuse > 0.0f)))
    return pl_fresnel(cosine, v->eta);
  const float f0 = pl_vec3f_max(v->f0);
  return f0 * v->base_out.all + (v->f90 - f0) * v->base_out.rise;
}

/* Sets the sampling probabilities in proportion to the light that each lobe sends to wo. */
static void set_chances(view *v, const pl_surface *s, pl_vec3f wo) {
  const float m = s->metallic, color = pl_vec3f_max(s->color), under = v->coat_out;
  const float mirror = m < 1.0f ? mirrored_part(v, s, wo.z) : 0.0f;
  const float metal = m > 0.0f ? m * pl_vec3f_max(pl_schlick(s->color, 1.0f, wo.z)) : 0.0f;
  const bool mirrors = v->eta > 0.0f || m > 0.0f || pl_maxf(pl_vec3f_max(v->f0), v->f90) > 0.0f;
  const float broad = v->out.broad, again = m * pl_ggx_returned(color, v->lost.mean);
  float *c = v->chance, sum = 0.0f;
  c[COAT] = 1.0f - under;
  c[MIRROR] = under * ((1.0f - m) * mirror + metal * (1.0f - broad));
  c[BROAD] = under * (v->diffuse * color * (1.0f - mirror) + broad * again);
  c[THROUGH] = under * v->through * color * pl_maxf(1.0f - mirror - broad, 0.0f);
  c[THROUGH_BROAD] = v->eta > 0.0f ? 0.0f : under * v->through * color * broad;
  for (int i = 0; i < CHOICES; i++)
    sum += c[i];
  const float least = CHANCE_MIN * pl_maxf(sum, 1e-6f);
  const bool present[CHOICES] = {v->coat_weight > 0.0f, mirrors, v->diffuse * color > 0.0f,
                                 v->through * color > 0.0f, false};
  sum = 0.0f;
  for (int i = 0; i < CHOICES; i++)
    sum += c[i] = present[i] ? pl_maxf(c[i], least) : pl_maxf(c[i], 0.0f);
  for (int i = 0; i < CHOICES; i++)
    c[i] = sum > 0.0f ? c[i] / sum : 0.0f;
}

static view view_of(const pl_surface *s, pl_vec3f wo) {
  const pl_lobes *lobes = &s->lobes;
  const float m = s->metallic, d = 1.0f - m, ay = pl_ggx_alpha(s->alpha);
  const float stretch = lobes->anisotropy * lobes->anisotropy;
  const float ax = pl_minf(ay + (1.0f - ay) * stretch, 1.0f);
  const float coat_alpha = pl_ggx_alpha(lobes->coat_alpha);
  view v = {
      .base = lobe_of(ax, ay, wo),
      .out.gain = 1.0f,
      .eta = eta_of(lobes),
      .coat_weight = lobes->inside ? 0.0f : lobes->coat,
      .diffuse = d * (1.0f - lobes->transmission),
      .through = d * lobes->transmission,
  };
  if (v.coat_weight > 0.0f) {
    set_coat_basis(&v, s, wo);
    v.coat = lobe_of(coat_alpha, coat_alpha, of_coat(&v, wo));
  }
  v.gives_back = m > 0.0f || (v.through > 0.0f && !(v.eta > 0.0f));
  if (v.gives_back || !v.base.even)
    v.lost = loss_of(&v.base);
  if (v.gives_back)
    v.out = lost_towards(&v.lost, wo);
  set_layers(&v, s, wo);
  set_chances(&v, s, wo);
  return v;
}

/* Multiple scattering without absorption (ggx_loss.h): a broad lobe, times cos(wi), and `more`, the
 * relative increase of the specular lobe. */
typedef struct several {
  float broad, more;
} several;

static several several_of(const view *v, pl_vec3f wi) {
  const pl_ggx_lost in = lost_towards(&v->lost, wi);
  const float lost = v->out.broad * in.broad;
  return (several){lost > 0.0f ? lost * fabsf(wi.z) / (PL_PI_F * v->lost.broad_mean) : 0.0f,
                   v->out.gain * in.gain - 1.0f};
}

/* Transmittance of the coat towards both directions: for specular lobes, and for a Lambertian base.
 */
typedef struct under_coat {
  float sharp, out, in, mean, deviation;
} under_coat;

static under_coat under_coat_of(const view *v, pl_vec3f wi) {
  const float weight = v->coat_weight;
  if (!(weight > 0.0f))
    return (under_coat){1.0f, 1.0f, 1.0f, 1.0f, 0.0f};
  const float in = passes_coat(v, wi);
  return (under_coat){pl_minf(v->coat_out, in), v->coat_out, in, 1.0f - weight * v->coat_table.mean,
                      weight * v->coat_table.deviation};
}

/* Directional albedos of the base's lobe towards wo and wi, and their mean. */
typedef struct base_albedo {
  pl_ggx_albedo out, in, mean;
  float deviation;
} base_albedo;

/* BRDF factor of the Lambertian base in one band, coat and dielectric included. The transmittances
 * of both layers fall towards grazing incidence: the mean of their product is at most the product
 * of their means plus that of their deviations. */
static float let_in(const under_coat *c, const base_albedo *a, float f0, float f90) {
  const float out = pl_ggx_entering(a->out, f0, f90), in = pl_ggx_entering(a->in, f0, f90);
  const float scatter = fabsf(f90 - f0) * a->deviation + f0 * sqrtf(1.0f - a->mean.all);
  const float mean = pl_ggx_entering(a->mean, f0, f90) * c->mean + scatter * c->deviation;
  return pl_ggx_base_share(c->out * out, c->in * in, mean);
}

static pl_vec3f base_fraction(const view *v, const pl_surface *s, const under_coat *c, pl_vec3f wo,
                              pl_vec3f wi) {
  if (v->eta > 0.0f && s->lobes.inside) {
    /* There is no table: the reflectance at the more grazing of both directions is used. */
    const float f = 1.0f - pl_fresnel(pl_minf(wo.z, wi.z), v->eta);
    return pl_vec3f_make(f, f, f);
  }
  const pl_ggx_dielectric d = v->base.even ? v->base_table : table_of(&v->base, wi, v->index);
  base_albedo a = {.out = v->base_out, .in = albedo_of(v, &d, wi)};
  a.mean = mean_of(v, &a.deviation);
  return pl_vec3f_make(let_in(c, &a, v->f0.x, v->f90), let_in(c, &a, v->f0.y, v->f90),
                       let_in(c, &a, v->f0.z, v->f90));
}

/* One band of the base: specular reflection, broad multiple scattering and diffuse reflection. */
static float band(float color, float mirrored, float again, float further, float diffuse) {
  return mirrored + again * pl_ggx_reflectance_mean(color) * further + diffuse * color;
}

static pl_vec3f above(const view *v, const pl_surface *s, pl_vec3f wo, pl_vec3f wi, pl_vec3f h) {
  const under_coat c = under_coat_of(v, wi);
  const float mirror = c.sharp * mirrored(&v->base, wo, wi, h);
  const float m = s->metallic;
  const several more = v->gives_back ? several_of(v, wi) : (several){0.0f, 0.0f};
  const pl_vec3f further = pl_ggx_further_of(s->color, v->lost.mean);
  const pl_vec3f f = mirror_of(v, s, pl_vec3f_dot(wo, h), more.more, further);
  const float again =
      m * more.broad > 0.0f ? m * pl_ggx_base_share(c.out, c.in, c.mean) * more.broad : 0.0f;
  const float lambert = v->diffuse * wi.z / PL_PI_F;
  const pl_vec3f fraction = lambert > 0.0f ? base_fraction(v, s, &c, wo, wi) : (pl_vec3f){0};
  const pl_vec3f base = {
      band(s->color.x, f.x * mirror, again, further.x, fraction.x * lambert),
      band(s->color.y, f.y * mirror, again, further.y, fraction.y * lambert),
      band(s->color.z, f.z * mirror, again, further.z, fraction.z * lambert),
  };
  const pl_vec3f out = of_coat(v, wo), in = of_coat(v, wi);
  if (!(v->coat_weight > 0.0f) || !(in.z > 0.0f))
    return base;
  const float coat =
      coat_fresnel(v, pl_vec3f_dot(wo, h)) * mirrored(&v->coat, out, in, of_coat(v, h));
  return pl_vec3f_make(coat + base.x, coat + base.y, coat + base.z);
}

/* Transmission through a thin wall: the specular lobe mirrored to the other side, with the light
 * that is not reflected; `wi` is mirrored too. A thin wall transmits straight on, blurred by its
 * roughness. */
static pl_vec3f below(const view *v, const pl_surface *s, pl_vec3f wo, pl_vec3f wi, pl_vec3f h) {
  const pl_vec3f f = dielectric_of(v, pl_vec3f_dot(wo, h));
  const float under = under_coat_of(v, wi).sharp;
  const float mirror = mirrored(&v->base, wo, wi, h), scale = under * v->through;
  const several more = several_of(v, wi);
  const float lobe = (1.0f + more.more) * mirror;
  return pl_vec3f_make(scale * s->color.x * ((1.0f - f.x) * lobe + more.broad),
                       scale * s->color.y * ((1.0f - f.y) * lobe + more.broad),
                       scale * s->color.z * ((1.0f - f.z) * lobe + more.broad));
}

/* Half vector that refracts wi (z < 0) to wo, on the viewer's side, and the Jacobian of wi's solid
 * angle (Walter et al. 2007, eq. 16 and 17); 0 if there is none. */
static float refracting(const view *v, pl_vec3f wo, pl_vec3f wi, pl_vec3f *h) {
  const pl_vec3f sum = pl_vec3f_madd(wo, v->eta, wi);
  *h = pl_vec3f_unit(sum.z < 0.0f ? pl_vec3f_scale(sum, -1.0f) : sum);
  const float out = pl_vec3f_dot(wo, *h), in = -pl_vec3f_dot(wi, *h);
  const float path = out - v->eta * in;
  return out > 0.0f && in > 0.0f ? v->eta * v->eta * in / (path * path) : 0.0f;
}

/* Transmission into a solid (Walter et al. 2007, eq. 21). Radiance is divided by the square of the
 * index, hence as in vacuum, where light sources and cameras are. Light that facets of rough
 * boundaries send to other facets is lost. */
static pl_vec3f refracted(const view *v, const pl_surface *s, pl_vec3f wo, pl_vec3f wi) {
  pl_vec3f h;
  const float change = refracting(v, wo, wi, &h);
  if (!(change > 0.0f))
    return pl_vec3f_make(0.0f, 0.0f, 0.0f);
  const float out = pl_vec3f_dot(wo, h);
  const float passed = (1.0f - pl_fresnel(out, v->eta)) * v->coat_out;
  const float scale = 4.0f * out * change * mirrored(&v->base, wo, wi, h) * passed * v->through;
  return pl_vec3f_scale(s->color, scale);
}

static pl_vec3f value_of(const view *v, const pl_surface *s, pl_vec3f wo, pl_vec3f wi) {
  if (wi.z < 0.0f && v->eta > 0.0f)
    return refracted(v, s, wo, wi);
  const pl_vec3f over = pl_vec3f_make(wi.x, wi.y, fabsf(wi.z));
  const pl_vec3f h = pl_vec3f_unit(pl_vec3f_add(wo, over));
  return wi.z > 0.0f ? above(v, s, wo, wi, h) : below(v, s, wo, over, h);
}

static float refracted_pdf(const view *v, pl_vec3f wo, pl_vec3f wi) {
  pl_vec3f h;
  const float change = refracting(v, wo, wi, &h);
  return change > 0.0f ? 4.0f * pl_vec3f_dot(wo, h) * change * mirrored_pdf(&v->base, wo, h) : 0.0f;
}

static float density_of(const view *v, pl_vec3f wo, pl_vec3f wi) {
  if (wi.z < 0.0f && v->eta > 0.0f)
    return v->chance[THROUGH] * refracted_pdf(v, wo, wi);
  const pl_vec3f over = pl_vec3f_make(wi.x, wi.y, fabsf(wi.z));
  const pl_vec3f h = pl_vec3f_unit(pl_vec3f_add(wo, over));
  const float mirror = mirrored_pdf(&v->base, wo, h), cosine = pl_cosine_hemisphere_pdf(over.z);
  if (wi.z < 0.0f)
    return v->chance[THROUGH] * mirror + v->chance[THROUGH_BROAD] * cosine;
  const pl_vec3f hc = of_coat(v, h);
  const float coat =
      v->chance[COAT] > 0.0f && hc.z > 0.0f ? mirrored_pdf(&v->coat, of_coat(v, wo), hc) : 0.0f;
  return v->chance[COAT] * coat + v->chance[MIRROR] * mirror + v->chance[BROAD] * cosine;
}

/* True if the BSDF can be non-zero for wi and wo. */
static bool admits(const pl_surface *s, pl_vec3f wo, pl_vec3f wi) {
  return wo.z > 0.0f && (wi.z > 0.0f || (wi.z < 0.0f && s->lobes.transmission > 0.0f));
}

static pl_vec3f evaluate(const pl_surface *s, pl_vec3f wo, pl_vec3f wi) {
  if (!admits(s, wo, wi))
    return pl_vec3f_make(0.0f, 0.0f, 0.0f);
  const view v = view_of(s, wo);
  return value_of(&v, s, wo, wi);
}

static float pdf(const pl_surface *s, pl_vec3f wo, pl_vec3f wi) {
  if (!admits(s, wo, wi))
    return 0.0f;
  const view v = view_of(s, wo);
  return density_of(&v, wo, wi);
}

/* Selects a lobe by a random number, and stretches the number to [0, 1) within the lobe's part. */
static int choose(const view *v, float *u) {
  int last = MIRROR;
  float left = 1.0f;
  for (int i = 0; i < CHOICES; i++) {
    if (!(v->chance[i] > 0.0f))
      continue;
    last = i; /* chosen if rounding leaves a remainder */
    if (v->chance[i] >= left || pl_sample_choose(v->chance[i] / left, u))
      break;
    left -= v->chance[i];
  }
  return last;
}

/* Samples wi from the chosen lobe; false if the sample is invalid. */
static bool draw(const view *v, int chosen, pl_vec3f wo, const float u[2], pl_vec3f *wi) {
  const bool passes = chosen == THROUGH || chosen == THROUGH_BROAD;
  if (chosen == BROAD || chosen == THROUGH_BROAD) {
    *wi = pl_sample_cosine_hemisphere(u[0], u[1]);
  } else {
    const lobe *l = chosen == COAT ? &v->coat : &v->base;
    pl_vec3f h = pl_ggx_visible_normal(l->ax, l->ay, chosen == COAT ? of_coat(v, wo) : wo, u);
    if (chosen == COAT && v->coat_bent)
      h = pl_basis_to_world(&v->coat_basis, h);
    if (passes && v->eta > 0.0f)
      return pl_refract(wo, h, v->eta, wi) && wi->z < 0.0f;
    *wi = pl_vec3f_sub(pl_vec3f_scale(h, 2.0f * pl_vec3f_dot(wo, h)), wo);
  }
  if (!(wi->z > 0.0f))
    return false;
  wi->z = passes ? -wi->z : wi->z;
  return true;
}

static bool sample(const pl_surface *s, pl_vec3f wo, const float u[2], pl_vec3f *wi,
                   pl_vec3f *weight, float *density) {
  if (!(wo.z > 0.0f))
    return false;
  const view v = view_of(s, wo);
  float r[2] = {u[0], u[1]};
  const int chosen = choose(&v, &r[0]);
  if (!draw(&v, chosen, wo, r, wi))
    return false;
  *density = density_of(&v, wo, *wi);
  if (!(*density > 0.0f))
    return false;
  *weight = pl_vec3f_scale(value_of(&v, s, wo, *wi), 1.0f / *density);
  return true;
}

const pl_reflectance pl_reflectance_principled = {
    .name = "principled",
    .doc = "metallic_roughness with anisotropy, index of refraction, specular tint, thin-walled "
           "or solid transmission and clear coat",
    .layered = true,
    .evaluate = evaluate,
    .pdf = pdf,
    .sample = sample,
    .inputs = pl_principled_inputs,
    .input_count = PL_PRINCIPLED_INPUTS,
    .set = pl_principled_set,
    .summarise = pl_principled_summarise,
};
