/* Means over four facets, and over the sides of rocks. */
#include "shade/rough.h"

#include "math/sampling.h"
#include "shade/reflectance.h"

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
                           const void *context, pl_vec3f mean, const pl_vec3f *slopes, int count,
                           float deviation) {
  pl_vec3f sum = {0.0f, 0.0f, 0.0f};
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

/* Slopes of all four facets, or of two that are opposite. */
typedef enum subset { ALL, ALONG, ACROSS } subset;

/* Mean over facets of a mean slope and of slopes around it, without those that others shade or
 * hide. */
static pl_vec3f reflect_facets(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi, pl_rough_fn law,
                               const void *context, const pl_rough *rough, subset of) {
  pl_vec3f slopes[4];
  if (!(wi.z > 0.0f && wo.z > 0.0f))
    return (pl_vec3f){0.0f, 0.0f, 0.0f};
  set_slopes(wo, wi, slopes);
  const float whole = sqrtf(rough->whole);
  const float lit = turned(slopes, whole, wi), seen = turned(slopes, whole, wo);
  const float deviation = sqrtf(rough->variance);
  const pl_vec3f pair[2] = {slopes[of == ACROSS], slopes[2 + (of == ACROSS)]};
  const int count = !(deviation > 0.0f) ? 1 : of == ALL ? 4 : 2;
  return pl_vec3f_scale(sum_facets(surface, wo, wi, law, context, rough->slope,
                                   of == ALL ? slopes : pair, count, deviation),
                        reached(lit, seen, wo, wi));
}

/* What is seen of rocks from above: a flat top and two rings of four sides, by their shares of it
 * and slopes over the height. */
enum { RINGS = 2, SIDES = 4 };
static const float TOP = 0.35f, RING[RINGS] = {0.45f, 0.2f}, STEEP[RINGS] = {1.81f, 13.35f};

/* Area that rocks turn to a direction, over that which they turn up: of sides all around. */
static float turned_stones(float height, pl_vec3f direction) {
  const float across = sqrtf(direction.x * direction.x + direction.y * direction.y);
  float sum = 1.0f;
  for (int k = 0; k < RINGS; k++) {
    const float steep = STEEP[k] * height * across / direction.z;
    if (steep > 1.0f)
      sum += RING[k] / (float)PL_PI * (sqrtf(steep * steep - 1.0f) - acosf(1.0f / steep));
  }
  return sum;
}

/* Light from a side of a rock, with relief of its own. */
static pl_vec3f reflect_side(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi, pl_rough_fn law,
                             const void *context, pl_vec3f slope, subset of) {
  const pl_vec3f up = {-slope.x, -slope.y, 1.0f};
  const float facing = pl_vec3f_dot(up, wo) / wo.z, relief = surface->rough.stone_relief;
  if (!(facing > 0.0f && pl_vec3f_dot(up, wi) > 0.0f))
    return (pl_vec3f){0.0f, 0.0f, 0.0f};
  const pl_basis side = pl_basis_make(pl_vec3f_unit(up));
  const pl_rough own = {.variance = relief, .whole = relief};
  return pl_vec3f_scale(reflect_facets(surface, pl_basis_to_local(&side, wo),
                                       pl_basis_to_local(&side, wi), law, context, &own, of),
                        facing);
}

/* The ground's surface with the relief and roughness of rocks. Where they are few, the law's own
 * roughness stands for both. */
static pl_surface stone_of(const pl_surface *ground) {
  static const float FEW = 0.01f;
  pl_surface stone = *ground;
  if (!stone.reflectance->photometric)
    return stone;
  if (stone.rough.stones < FEW)
    stone.rough.stone_relief = 0.0f;
  for (int k = 0; k < 3 && stone.rough.stones >= FEW; k++)
    stone.regolith.band[k].roughness_rad = stone.rough.stone_roughness_rad[k];
  return stone;
}

static pl_vec3f sum_sides(const pl_surface *ground, pl_vec3f wo, pl_vec3f wi, pl_rough_fn law,
                          const void *context) {
  const pl_surface stone = stone_of(ground), *surface = &stone;
  const pl_vec3f flat = {0.0f, 0.0f, 0.0f};
  pl_vec3f slopes[SIDES];
  set_slopes(wo, wi, slopes);
  pl_vec3f sum = pl_vec3f_scale(reflect_side(surface, wo, wi, law, context, flat, ALL), TOP);
  for (int ring = 0; ring < RINGS; ring++) {
    const float size = 0.5f * STEEP[ring] * surface->rough.stone_height;
    for (int k = 0; k < SIDES; k++) {
      /* Between the directions of facets, so that two of four face the lower one. */
      const pl_vec3f between =
          pl_vec3f_scale(pl_vec3f_add(slopes[k], slopes[(k + 1) % SIDES]), size);
      sum = pl_vec3f_madd(
          sum, RING[ring] / SIDES,
          reflect_side(surface, wo, wi, law, context, between, (ring + k) % 2 ? ALONG : ACROSS));
    }
  }
  return sum;
}

/* Lays rocks on ground of this reflectance. Half of what they shade of the ground, they shade of
 * each other. */
static pl_vec3f lay_stones(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi, pl_rough_fn law,
                           const void *context, pl_vec3f ground) {
  const float share = surface->rough.stones, height = surface->rough.stone_height;
  const float lit = turned_stones(height, wi), seen = turned_stones(height, wo);
  const float hidden = 1.0f / reached(lit, seen, wo, wi);
  const float shown = -expm1f(-share * seen) / seen * expf(-0.5f * share * (hidden - seen));
  return pl_vec3f_madd(pl_vec3f_scale(ground, expf(-share * hidden)), shown,
                       sum_sides(surface, wo, wi, law, context));
}

pl_vec3f pl_rough_reflect(const pl_surface *surface, pl_vec3f wo, pl_vec3f wi, pl_rough_fn law,
                          const void *context) {
  if (!(wi.z > 0.0f && wo.z > 0.0f))
    return (pl_vec3f){0.0f, 0.0f, 0.0f};
  pl_rough rough = surface->rough;
  rough.slope = pl_surface_to_local(surface, rough.slope);
  const pl_vec3f ground = reflect_facets(surface, wo, wi, law, context, &rough, ALL);
  return rough.stones > 0.0f ? lay_stones(surface, wo, wi, law, context, ground) : ground;
}
