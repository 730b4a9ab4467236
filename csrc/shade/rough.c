/* Means over four facets, and over the sides of rocks. */
#include "shade/rough.h"

#include "math/sampling.h"

/* Slopes with a variance of 1 along the lower of both directions and across it. */
static void set_slopes(pl_vec3f wo, pl_vec3f wi, pl_vec3f out[4]) {
  const pl_vec3f low = wi.z < wo.z ? wi : wo;
  const float along = sqrtf(low.x * low.x + low.y * low.y), size = sqrtf(2.0f);
  const float x = along > 0.0f ? size * low.x / along : size;
  const float y = along > 0.0f ? size * low.y / along : 0.0f;
  out[0] = (pl_vec3f){x, y, 0.0f};
  out[1] = (pl_vec3f){-y, x, 0.0f};
  out[2] = (pl_vec3f){-x, -y, 0.0f};
  out[3] = (pl_vec3f){y, -x, 0.0f};
}

/* Mean of the area that facets of a deviation turn to a direction, over that of the mean surface:
 * 1 plus Smith's function Lambda. */
static float turned(const pl_vec3f slopes[4], float deviation, pl_vec3f direction) {
  float sum = 0.0f;
  for (int k = 0; k < 4; k++)
    sum += pl_maxf(direction.z - deviation * pl_vec3f_dot(slopes[k], direction), 0.0f);
  return sum / (4.0f * direction.z);
}

/* Share of facets that both light and viewer reach: the same ones if both come from one side,
 * independent ones if from different sides. */
static float reached(float lit, float seen, pl_vec3f wo, pl_vec3f wi) {
  if (!(lit > 1.0f || seen > 1.0f))
    return 1.0f;
  const float cross = wo.x * wi.y - wo.y * wi.x, along = wo.x * wi.x + wo.y * wi.y;
  const float apart = 4.41f * fabsf(atan2f(cross, along));
  const float more = pl_maxf(lit, seen) - 1.0f, less = pl_minf(lit, seen) - 1.0f;
  return 1.0f / (1.0f + more + apart / (apart + 1.0f) * less);
}

/* Sum over facets of a mean slope and slopes around it, by the areas that the viewer sees, those
 * hidden by others included. */
static pl_vec3f sum_facets(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi, pl_rough_fn law,
                           const void *context, pl_vec3f mean, const pl_vec3f slopes[4],
                           float deviation) {
  pl_vec3f sum = {0.0f, 0.0f, 0.0f};
  const int count = deviation > 0.0f ? 4 : 1;
  for (int k = 0; k < count; k++) {
    const pl_vec3f slope = pl_vec3f_madd(mean, deviation, slopes[k]);
    const pl_vec3f up = {-slope.x, -slope.y, 1.0f};
    const float facing = pl_vec3f_dot(up, wo) / wo.z;
    if (!(facing > 0.0f && pl_vec3f_dot(up, wi) > 0.0f))
      continue;
    const pl_basis facet = pl_basis_make(pl_vec3f_unit(up));
    sum = pl_vec3f_madd(
        sum, facing / (float)count,
        law(surface, pl_basis_to_local(&facet, wo), pl_basis_to_local(&facet, wi), context));
  }
  return sum;
}

/* Lays rocks on ground of this reflectance. */
static pl_vec3f lay_stones(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi, pl_rough_fn law,
                           const void *context, const pl_vec3f slopes[4], pl_vec3f ground) {
  static const float SLOPE = 2.8284271f; /* of the sides over their height, for a dome's shadow */
  const pl_vec3f flat = {0.0f, 0.0f, 0.0f};
  const float share = surface->rough.stones, slope = SLOPE * surface->rough.stone_height;
  const float lit = turned(slopes, slope, wi), seen = turned(slopes, slope, wo);
  const pl_vec3f sides = sum_facets(surface, wo, wi, law, context, flat, slopes, slope);
  const float bare = expf(-share / reached(lit, seen, wo, wi));
  const float shown = -expm1f(-share * seen) / seen;
  return pl_vec3f_madd(pl_vec3f_scale(ground, bare), shown, sides);
}

pl_vec3f pl_rough_reflect(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi, pl_rough_fn law,
                          const void *context) {
  const pl_rough *rough = &surface->rough;
  pl_vec3f slopes[4];
  if (!(wi.z > 0.0f && wo.z > 0.0f))
    return (pl_vec3f){0.0f, 0.0f, 0.0f};
  set_slopes(wo, wi, slopes);
  const pl_vec3f mean = pl_surface_to_local(surface, rough->slope);
  const float whole = sqrtf(rough->whole);
  const float lit = turned(slopes, whole, wi), seen = turned(slopes, whole, wo);
  const pl_vec3f ground = pl_vec3f_scale(
      sum_facets(surface, wo, wi, law, context, mean, slopes, sqrtf(rough->variance)),
      reached(lit, seen, wo, wi));
  return rough->stones > 0.0f ? lay_stones(surface, wo, wi, law, context, slopes, ground) : ground;
}
