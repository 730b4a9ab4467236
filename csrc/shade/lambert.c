/* Lambert: radiance independent of direction, albedo = base colour. */
#include "math/sampling.h"
#include "shade/rough.h"
#include "shade/reflectance.h"

static pl_vec3f facet(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi, const void *context) {
  (void)wo;
  (void)context;
  return pl_vec3f_scale(surface->color, pl_cosine_hemisphere_pdf(wi.z));
}

static pl_vec3f evaluate(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi) {
  return pl_rough_on(&surface->rough) ? pl_rough_reflect(surface, wo, wi, facet, NULL)
                                      : facet(surface, wo, wi, NULL);
}

static float pdf(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi) {
  (void)surface;
  (void)wo;
  return pl_cosine_hemisphere_pdf(wi.z);
}

static float pdf_most(const pl_surface *surface, pl_vec3f wo) {
  (void)surface;
  (void)wo;
  return pl_cosine_hemisphere_pdf(1.0f);
}

static bool sample(const pl_surface *surface, pl_vec3f wo, const float u[2], pl_vec3f *wi,
                   pl_vec3f *weight, float *density) {
  (void)wo;
  *wi = pl_sample_cosine_hemisphere(u[0], u[1]);
  *density = pl_cosine_hemisphere_pdf(wi->z);
  *weight = surface->color;
  return *density > 0.0f;
}

const pl_reflectance pl_reflectance_lambert = {
    .name = "lambert",
    .doc = "Lambert: albedo/pi in every direction",
    .evaluate = evaluate,
    .pdf = pdf,
    .pdf_most = pdf_most,
    .sample = sample,
};
