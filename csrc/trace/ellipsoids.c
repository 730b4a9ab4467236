/* Rays at smooth bodies. */
#include "geom/ellipsoid.h"
#include "trace/instance.h"
#include "trace/intersect.h"

/* Returns the distance to a body, or infinity if that is none or beyond the limit. Its bounding
 * sphere is tested first, with a margin for rounding. */
static double body_distance(const pl_shot_body *body, const pl_ray *ray, double limit_m) {
  if (!pl_shot_is_smooth(body))
    return INFINITY;
  const pl_vec3 o = ray->origin, d = ray->direction;
  const pl_vec3 to_center = pl_vec3_sub(body->center, o);
  const double along = pl_vec3_dot(to_center, d), square = pl_vec3_dot(to_center, to_center);
  const double reach = body->radius_m * body->radius_m * (1.0 + 1e-6) + 1e-6 * square;
  const double before = limit_m + body->radius_m; /* a centre farther away has no nearer surface */
  if (square - along * along > reach || (along < 0.0 && square > reach) ||
      square * (1.0 - 1e-6) > before * before)
    return INFINITY;
  const pl_vec3 origin = pl_vec3_add(body->camera_unit, pl_mat3_mul_vec(body->to_unit, o));
  double t;
  return pl_unit_sphere_intersect(origin, pl_mat3_mul_vec(body->to_unit, d), 0.0, &t) ? t
                                                                                      : INFINITY;
}

uint32_t pl_next_body(const pl_snapshot *shot, const pl_ray *ray, double limit_m, size_t *k) {
  const pl_sphere_tree *tree = &shot->body_tree;
  double start_m;
  while (*k < tree->count) {
    const pl_sphere *sphere = &tree->nodes[*k];
    const bool inner = sphere->item == PL_INNER_NODE;
    const bool entered =
        inner && pl_ray_enter(ray, limit_m, sphere->center, sphere->radius_m, &start_m);
    *k = pl_sphere_next(tree, *k, entered);
    if (!inner && sphere->item != ray->skip_body)
      return sphere->item;
  }
  return PL_NO_BODY;
}

static double limit_of(const pl_ray *ray, const pl_hit *hit) {
  return !pl_surface_is_none(hit->surface_id) ? hit->t : ray->t_max;
}

static void closest_of(const pl_snapshot *shot, const pl_ray *ray, pl_hit *hit) {
  size_t k = 0;
  if (ray->skip_body == PL_EVERY_ELLIPSOID)
    return;
  for (uint32_t b; (b = pl_next_body(shot, ray, limit_of(ray, hit), &k)) != PL_NO_BODY;) {
    const double limit_m = limit_of(ray, hit), t = body_distance(&shot->bodies[b], ray, limit_m);
    if (t < limit_m)
      *hit = (pl_hit){.surface_id = pl_surface_of_body(b), .t = t};
  }
}

static void closest(const pl_snapshot *shot, const pl_ray *rays, pl_hit *hits, size_t count) {
  for (size_t i = 0; i < count; i++)
    closest_of(shot, &rays[i], &hits[i]);
}

static bool is_occluded(const pl_snapshot *shot, const pl_ray *ray) {
  size_t k = 0;
  if (ray->skip_body == PL_EVERY_ELLIPSOID)
    return false;
  for (uint32_t b; (b = pl_next_body(shot, ray, ray->t_max, &k)) != PL_NO_BODY;)
    if (body_distance(&shot->bodies[b], ray, ray->t_max) < ray->t_max)
      return true;
  return false;
}

static void occluded(const pl_snapshot *shot, const pl_ray *rays, bool *out, size_t count) {
  for (size_t i = 0; i < count; i++)
    out[i] = out[i] || is_occluded(shot, &rays[i]);
}

const pl_intersect pl_intersect_ellipsoids = {.closest = closest, .occluded = occluded};
