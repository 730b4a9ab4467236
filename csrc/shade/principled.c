/* The principled surface: the metallic-roughness base with anisotropy, index of refraction and
 * specular tint, light that passes thin walls or the boundaries of solids, and a clear coat on top.
 */
#include "shade/ggx.h"
#include "shade/ggx_loss.h"
#include "shade/ggx_loss_xy.h"
#include "shade/principled_inputs.h"
#include "shade/reflectance.h"
#include "shade/refraction.h"

/* Coats have index 1.5 (KHR_materials_clearcoat). */
static const float COAT_F0 = 0.04f;
/* The least chance of a lobe that is there, as a part of all. */
static const float CHANCE_MIN = 0.1f;

/* What a draw can choose: the coat, the base's mirror lobe, the broad rest above (diffuse, multiple
 * reflection); below the surface the mirror lobe turned over, and its broad rest. */
enum { COAT, MIRROR, BROAD, THROUGH, THROUGH_BROAD, CHOICES };

typedef struct lobe {
  float ax, ay;
  float lambda; /* of the outgoing direction */
} lobe;

/* What evaluating, drawing and densities share for one outgoing direction. */
typedef struct view {
  lobe base, coat;
  bool coat_bent; /* the coat has a normal of its own */
  pl_basis coat_basis;
  pl_vec3f f0;
  float f90;
  float eta; /* of the solid: index behind the surface over that before it; 0: a thin wall */
  float coat_weight, diffuse, through; /* of the light; the latter two of what the base lets in */
  float loss, loss_mean;               /* of the base's lobe, where light is given back; or 0 */
  float chance[CHOICES];
} view;

static lobe lobe_of(float ax, float ay, pl_vec3f wo) {
  return (lobe){ax, ay, pl_ggx_lambda_xy(ax, ay, wo)};
}

/* Single reflection by a lobe that mirrors everything, times cos(wi); height-correlated Smith
 * (Heitz 2014, eq. 99). */
static float mirrored(const lobe *l, pl_vec3f wo, pl_vec3f wi, pl_vec3f h) {
  const float g = 1.0f / (1.0f + l->lambda + pl_ggx_lambda_xy(l->ax, l->ay, wi));
  return pl_ggx_density(l->ax, l->ay, h) * g / (4.0f * pl_maxf(wo.z, PL_GGX_COSINE_MIN));
}

/* Density of drawing wi by visible normals (Heitz 2018, eq. 17). */
static float mirrored_pdf(const lobe *l, pl_vec3f wo, pl_vec3f h) {
  return pl_ggx_density(l->ax, l->ay, h) /
         (4.0f * pl_maxf(wo.z, PL_GGX_COSINE_MIN) * (1.0f + l->lambda));
}

/* Light that the lobe loses towards w, and the mean of that over the hemisphere. */
static float loss_towards(const lobe *l, pl_vec3f w) {
  return l->ax > l->ay ? pl_ggx_loss_xy(l->ax, l->ay, w) : pl_ggx_loss(sqrtf(l->ay), fabsf(w.z));
}
static float loss_mean(const lobe *l) {
  return l->ax > l->ay ? pl_ggx_loss_xy_mean(l->ax, l->ay) : pl_ggx_loss_mean(sqrtf(l->ay));
}

/* A direction of the surface's frame in the coat's. */
static pl_vec3f of_coat(const view *v, pl_vec3f w) {
  return v->coat_bent ? pl_basis_to_local(&v->coat_basis, w) : w;
}

/* The coat's frame. A normal that leans away from the viewer is brought back to grazing. */
static void set_coat_basis(view *v, const pl_surface *s, pl_vec3f wo) {
  const pl_vec3f n = pl_surface_to_local(s, s->lobes.coat_normal);
  const float least = 1e-3f, cosine = pl_vec3f_dot(n, wo);
  v->coat_bent = pl_vec3f_dot(n, n) > 0.5f;
  if (v->coat_bent)
    v->coat_basis = pl_basis_make(
        cosine < least ? pl_vec3f_unit(pl_vec3f_madd(n, least - cosine, wo)) : pl_vec3f_unit(n));
}

static float coat_fresnel(const view *v, float cosine) {
  return v->coat_weight * pl_schlick(pl_vec3f_make(COAT_F0, COAT_F0, COAT_F0), 1.0f, cosine).x;
}

/* What the base mirrors at a cosine. A solid's part follows Fresnel, that all is mirrored where no
 * light can leave; otherwise Schlick is near enough. */
static pl_vec3f mirror_of(const view *v, const pl_surface *s, float cosine) {
  if (!(v->eta > 0.0f))
    return pl_schlick(v->f0, v->f90, cosine);
  const pl_vec3f metal = pl_vec3f_scale(pl_schlick(s->color, 1.0f, cosine), s->metallic);
  const float f = (1.0f - s->metallic) * pl_fresnel(cosine, v->eta);
  return pl_vec3f_make(metal.x + f, metal.y + f, metal.z + f);
}

/* The ratio of indices at the surface of a solid. One like vacuum has no surface: 0. */
static float eta_of(const pl_lobes *l) {
  if (!(l->ior > 0.0f && l->transmission > 0.0f) || fabsf(l->ior - 1.0f) < 1e-3f)
    return 0.0f;
  return l->inside ? 1.0f / l->ior : l->ior;
}

/* Chances by the light that each lobe sends on, as seen from wo. */
static void set_chances(view *v, const pl_surface *s, pl_vec3f wo) {
  float *c = v->chance, sum = 0.0f;
  const float under = 1.0f - coat_fresnel(v, of_coat(v, wo).z), color = pl_vec3f_max(s->color);
  const float mirror = pl_vec3f_max(mirror_of(v, s, wo.z));
  const bool mirrors = v->eta > 0.0f || pl_maxf(pl_vec3f_max(v->f0), v->f90) > 0.0f;
  const float again =
      s->metallic > 0.0f ? pl_ggx_returned(pl_vec3f_max(v->f0), v->loss_mean) : 0.0f;
  c[COAT] = 1.0f - under;
  c[MIRROR] = under * mirror;
  c[BROAD] = under * (v->diffuse * color + v->loss * again);
  c[THROUGH] = under * v->through * color * (1.0f - mirror);
  c[THROUGH_BROAD] = v->eta > 0.0f ? 0.0f : under * v->through * color * v->loss;
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
      .eta = eta_of(lobes),
      .coat_weight = lobes->inside ? 0.0f : lobes->coat,
      .f0 = {d * lobes->f0.x + m * s->color.x, d * lobes->f0.y + m * s->color.y,
             d * lobes->f0.z + m * s->color.z},
      .f90 = d * lobes->f90 + m,
      .diffuse = d * (1.0f - lobes->transmission),
      .through = d * lobes->transmission,
  };
  if (v.coat_weight > 0.0f) {
    set_coat_basis(&v, s, wo);
    v.coat = lobe_of(coat_alpha, coat_alpha, of_coat(&v, wo));
  }
  if (m > 0.0f || (v.through > 0.0f && !(v.eta > 0.0f))) {
    v.loss = loss_towards(&v.base, wo);
    v.loss_mean = loss_mean(&v.base);
  }
  set_chances(&v, s, wo);
  return v;
}

/* Light that comes back after several hits, times cos(wi), if all of it does (Kulla and Conty
 * 2017). */
static float again_of(const view *v, pl_vec3f wi) {
  const float lost = v->loss > 0.0f ? v->loss * loss_towards(&v->base, wi) : 0.0f;
  return lost > 0.0f ? lost * fabsf(wi.z) / (PL_PI_F * v->loss_mean) : 0.0f;
}

/* One band above the surface, without the coat. `let_in`: the mirror's reflectance at the more
 * grazing direction, which the diffuse base misses (see metallic_roughness.c). */
static float band(const view *v, float f0, float f, float let_in, float color, float mirror,
                  float again, float diffuse) {
  return f * mirror + again * pl_ggx_returned(f0, v->loss_mean) + (1.0f - let_in) * diffuse * color;
}

static pl_vec3f above(const view *v, const pl_surface *s, pl_vec3f wo, pl_vec3f wi, pl_vec3f h) {
  const float grazing = pl_minf(wo.z, wi.z), mirror = mirrored(&v->base, wo, wi, h);
  const pl_vec3f f = mirror_of(v, s, pl_vec3f_dot(wo, h));
  const pl_vec3f let_in = mirror_of(v, s, grazing);
  const float again = s->metallic > 0.0f ? again_of(v, wi) : 0.0f;
  const float diffuse = v->diffuse * wi.z / PL_PI_F;
  const pl_vec3f base = {
      band(v, v->f0.x, f.x, let_in.x, s->color.x, mirror, again, diffuse),
      band(v, v->f0.y, f.y, let_in.y, s->color.y, mirror, again, diffuse),
      band(v, v->f0.z, f.z, let_in.z, s->color.z, mirror, again, diffuse),
  };
  if (!(v->coat_weight > 0.0f))
    return base;
  const pl_vec3f out = of_coat(v, wo), in = of_coat(v, wi);
  const float coat = in.z > 0.0f ? coat_fresnel(v, pl_vec3f_dot(wo, h)) *
                                       mirrored(&v->coat, out, in, of_coat(v, h))
                                 : 0.0f;
  const float under = 1.0f - coat_fresnel(v, pl_minf(out.z, in.z));
  return pl_vec3f_make(coat + under * base.x, coat + under * base.y, coat + under * base.z);
}

/* What passes: the mirror lobe turned over with the light that is not mirrored; `wi` is turned over
 * too. A thin wall sends light straight on, blurred by its roughness. */
static pl_vec3f below(const view *v, const pl_surface *s, pl_vec3f wo, pl_vec3f wi, pl_vec3f h) {
  const pl_vec3f f = pl_schlick(v->f0, v->f90, pl_vec3f_dot(wo, h));
  const float under = 1.0f - coat_fresnel(v, pl_minf(of_coat(v, wo).z, fabsf(of_coat(v, wi).z)));
  const float mirror = mirrored(&v->base, wo, wi, h), again = again_of(v, wi);
  const float scale = under * v->through;
  return pl_vec3f_make(scale * s->color.x * ((1.0f - f.x) * mirror + again),
                       scale * s->color.y * ((1.0f - f.y) * mirror + again),
                       scale * s->color.z * ((1.0f - f.z) * mirror + again));
}

/* The normal that refracts wi (z < 0) to wo, on the viewer's side, and the change of wi's solid
 * angle with it (Walter et al. 2007, eq. 16 and 17); 0 if there is none. */
static float refracting(const view *v, pl_vec3f wo, pl_vec3f wi, pl_vec3f *h) {
  const pl_vec3f sum = pl_vec3f_madd(wo, v->eta, wi);
  *h = pl_vec3f_unit(sum.z < 0.0f ? pl_vec3f_scale(sum, -1.0f) : sum);
  const float out = pl_vec3f_dot(wo, *h), in = -pl_vec3f_dot(wi, *h);
  const float path = out - v->eta * in;
  return out > 0.0f && in > 0.0f ? v->eta * v->eta * in / (path * path) : 0.0f;
}

/* What a solid lets pass (Walter et al. 2007, eq. 21). Radiance is counted as in vacuum, over the
 * square of the index: light sources and cameras are there. Light that facets of rough boundaries
 * send on to other facets is lost. */
static pl_vec3f refracted(const view *v, const pl_surface *s, pl_vec3f wo, pl_vec3f wi) {
  pl_vec3f h;
  const float change = refracting(v, wo, wi, &h);
  if (!(change > 0.0f))
    return pl_vec3f_make(0.0f, 0.0f, 0.0f);
  const float out = pl_vec3f_dot(wo, h), coat = of_coat(v, wo).z;
  const float passed = (1.0f - pl_fresnel(out, v->eta)) * (1.0f - coat_fresnel(v, coat));
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

/* Whether light can go from wi to wo at all. */
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

/* The lobe that `choice` falls on. */
static int choose(const view *v, float choice) {
  int last = MIRROR;
  for (int i = 0; i < CHOICES; i++) {
    if (!(v->chance[i] > 0.0f))
      continue;
    if (choice < v->chance[i])
      return i;
    choice -= v->chance[i];
    last = i; /* where rounding leaves a rest */
  }
  return last;
}

/* False: nothing comes of this draw. */
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

static bool sample(const pl_surface *s, pl_vec3f wo, const float u[2], float choice, pl_vec3f *wi,
                   pl_vec3f *weight, float *density) {
  if (!(wo.z > 0.0f))
    return false;
  const view v = view_of(s, wo);
  const int chosen = choose(&v, choice);
  if (!draw(&v, chosen, wo, u, wi))
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
