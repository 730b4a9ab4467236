/* Rays at the few smooth bodies. */
#include "geom/ellipsoid.h"
#include "trace/intersect.h"

/* Returns the distance to a body, or infinity. Its bounding sphere is tested first, with a margin
 * for rounding. */
static double body_distance(const pl_shot_body *body, const pl_ray *ray) {
  if (!pl_shot_is_smooth(body))
    return INFINITY;
  const pl_vec3 o = ray->origin, d = ray->direction;
  const pl_vec3 to_center = pl_vec3_sub(body->center, o);
  const double along = pl_vec3_dot(to_center, d), square = pl_vec3_dot(to_center, to_center);
  const double reach = body->radius_m * body->radius_m * (1.0 + 1e-6) + 1e-6 * square;
  if (square - along * along > reach || (along < 0.0 && square > reach))
    return INFINITY;
  const pl_vec3 origin = pl_vec3_add(body->camera_unit, pl_mat3_mul_vec(body->to_unit, o));
  double t;
  return pl_unit_sphere_intersect(origin, pl_mat3_mul_vec(body->to_unit, d), 0.0, &t) ? t
                                                                                      : INFINITY;
}

static void closest_of(const pl_snapshot *shot, const pl_ray *ray, pl_hit *hit) {
  if (ray->skip_body == PL_EVERY_BODY)
    return;
  for (size_t b = 0; b < shot->body_count; b++) {
    if (ray->skip_body == b)
      continue;
    const double t = body_distance(&shot->bodies[b], ray);
    const double limit = !pl_surface_is_none(hit->surface_id) ? hit->t : ray->t_max;
    if (t < limit)
      *hit = (pl_hit){.surface_id = pl_surface_of_body(b), .t = t};
  }
}

static void closest(const pl_snapshot *shot, const pl_ray *rays, pl_hit *hits, size_t count) {
  for (size_t i = 0; i < count; i++)
    closest_of(shot, &rays[i], &hits[i]);
}

static bool is_occluded(const pl_snapshot *shot, const pl_ray *ray) {
  if (ray->skip_body == PL_EVERY_BODY)
    return false;
  for (size_t b = 0; b < shot->body_count; b++)
    if (ray->skip_body != b && body_distance(&shot->bodies[b], ray) < ray->t_max)
      return true;
  return false;
}

static void occluded(const pl_snapshot *shot, const pl_ray *rays, bool *out, size_t count) {
  for (size_t i = 0; i < count; i++)
    out[i] = out[i] || is_occluded(shot, &rays[i]);
}

const pl_intersect pl_intersect_ellipsoids = {.closest = closest, .occluded = occluded};
