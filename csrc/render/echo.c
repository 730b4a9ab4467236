/* Echoes of single surfaces, and the ways on from mirrors and clear walls. */
#include "render/echo.h"

#include "shade/ggx.h"
#include "shade/reflectance.h"

/* Rougher surfaces scatter what they mirror or transmit over more than a beam: GGX alpha of a
 * roughness of 0.1. */
#define SMOOTH_ALPHA 0.0101f
/* Power that is not worth following. */
#define LOST 1e-5f

static float band_of(pl_vec3f v, int band) { return band == 0 ? v.x : band == 1 ? v.y : v.z; }

static pl_vec3f back_of(const pl_surface *s, const pl_echo_ray *ray) {
  return pl_surface_to_local(s, pl_vec3_to_float(pl_vec3_scale(ray->beam.direction, -1.0)));
}

void pl_echo_at(const pl_snapshot *shot, const pl_echo_ray *ray, int band, pl_vertex *vertex,
                pl_echo *out) {
  /* Rays of craters on terrain need tiles that are made for them. */
  pl_detail detail = PL_DETAIL_FULL;
  detail.rays = false;
  pl_vertex_shade(shot, &ray->beam, detail, vertex);
  const pl_surface *s = &vertex->surface;
  pl_vertex_face_layers(vertex);
  const pl_vec3f back = back_of(s, ray);
  const float brdf = band_of(s->reflectance->evaluate(s, back, back), band);
  *out = (pl_echo){
      .range_m = ray->way_m + vertex->t,
      .reflectance = PL_PI_F * brdf * ray->passed * ray->passed,
      .incidence_rad = acosf(pl_minf(pl_maxf(back.z, -1.0f), 1.0f)),
      .index = ray->index,
      .path = ray->path,
  };
}

static bool is_smooth(const pl_surface *s) {
  const bool gloss =
      s->reflectance->layered || s->reflectance == pl_reflectance_find("metallic_roughness");
  return gloss && pl_ggx_alpha(s->alpha) <= SMOOTH_ALPHA;
}

/* Part of the light that a smooth surface mirrors. The value of a GGX lobe in its mirror direction
 * is F / (4 pi alpha^2 cos) (Walter et al. 2007, with G of 1). */
static float mirrored(const pl_surface *s, pl_vec3f back, int band) {
  const pl_vec3f onward = {-back.x, -back.y, back.z};
  const float alpha = pl_ggx_alpha(s->alpha);
  const float peak = band_of(s->reflectance->evaluate(s, back, onward), band);
  return pl_minf(4.0f * PL_PI_F * alpha * alpha * back.z * peak, 1.0f);
}

static float transmitted(const pl_surface *s, float mirrors, int band) {
  if (!s->reflectance->layered)
    return 0.0f;
  return s->lobes.transmission * (1.0f - s->metallic) * (1.0f - mirrors) * band_of(s->color, band);
}

/* In double: on a way of its length a rounded direction is off by many roundings of the range. */
static pl_vec3 mirror_image(pl_vec3 ahead, pl_vec3f n) {
  const pl_vec3 normal = pl_vec3_unit(pl_vec3f_to_double(n));
  return pl_vec3_sub(ahead, pl_vec3_scale(normal, 2.0 * pl_vec3_dot(ahead, normal)));
}

bool pl_echo_continue(const pl_snapshot *shot, const pl_echo_ray *ray, int band,
                      const pl_vertex *vertex, pl_echo_ray *next, pl_ray *query) {
  const pl_surface *s = &vertex->surface;
  if (!is_smooth(s))
    return false;
  const pl_vec3f back = back_of(s, ray);
  const pl_vec3 ahead = ray->beam.direction;
  const float mirrors = mirrored(s, back, band), passes = transmitted(s, mirrors, band);
  const bool through = passes > mirrors;
  const float part = ray->passed * (through ? passes : mirrors);
  if (!(part * part > LOST))
    return false;
  const pl_vec3 onward = through ? ahead : mirror_image(ahead, s->n);
  if (!through && !(pl_vec3_dot(onward, pl_vec3f_to_double(s->ng)) > 0.0))
    return false; /* the interpolated normal sends it into the surface */
  *query = pl_vertex_ray(vertex, shot, pl_vec3_to_float(onward), INFINITY);
  query->direction = onward; /* not rounded */
  *next = *ray;
  next->beam.origin = query->origin;
  next->beam.direction = query->direction;
  next->beam.width_m = pl_beam_width(&ray->beam, vertex->t);
  next->way_m = ray->way_m + vertex->t;
  next->passed = part;
  next->path = (uint8_t)(ray->path | (through ? PL_ECHO_THROUGH : PL_ECHO_MIRRORED));
  return true;
}
