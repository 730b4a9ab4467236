#include "annotate/clear_view.h"

/* Relative, of distances, and of the angle of a cone. */
static const double ROUNDING = 1e-9;
/* Cones of a larger chord, from the axis to the rays, are not looked at. */
static const double WIDEST = 0.5;

/* Half the angle of a cone about an axis that has all rays; infinite if it is wide. */
static double half_angle_of(const pl_sight_query *queries, size_t count, pl_vec3 axis) {
  double chord = 0.0;
  for (size_t i = 0; i < count; i++)
    chord = fmax(chord, pl_vec3_norm(pl_vec3_sub(queries[i].ray.direction, axis)));
  return chord < WIDEST ? 2.0 * asin(0.5 * chord) + ROUNDING : INFINITY;
}

void pl_bodies_near_find(const pl_snapshot *shot, const pl_sight_query *queries, size_t count,
                         pl_bodies_near *out) {
  pl_vec3 sum = {0.0, 0.0, 0.0};
  for (size_t i = 0; i < count; i++)
    sum = pl_vec3_add(sum, queries[i].ray.direction);
  const pl_vec3 axis = pl_vec3_unit(sum);
  const double half_angle_rad = half_angle_of(queries, count, axis);
  *out = (pl_bodies_near){.all = isinf(half_angle_rad)};
  for (size_t i = 0; i < shot->body_count && !out->all; i++) {
    const pl_shot_body *body = &shot->bodies[i];
    if (!pl_shot_is_smooth(body) ||
        !pl_sphere_in_cone(body->center, body->radius_m, axis, half_angle_rad))
      continue;
    out->all = out->count == PL_BODIES_NEAR;
    if (!out->all)
      out->bodies[out->count++] = (uint32_t)i;
  }
}

bool pl_bodies_near_hide(const pl_snapshot *shot, const pl_bodies_near *near, const pl_sight *sight,
                         const pl_sight_query *query) {
  const bool smooth = sight->is_point && pl_surface_is_ellipsoid(sight->surface_id);
  const double far_m = sight->is_point ? query->distance_m * (1.0 + ROUNDING) : INFINITY;
  for (size_t i = 0; i < near->count; i++) {
    const pl_shot_body *body = &shot->bodies[near->bodies[i]];
    const bool own = smooth && near->bodies[i] == sight->index;
    if (!own && pl_vec3_norm(body->center) - body->radius_m * (1.0 + ROUNDING) <= far_m)
      return true;
  }
  return near->all;
}

bool pl_sight_may_meet_mesh(const pl_sight_frame *frame, const double pixel[2]) {
  return frame->meshes == NULL || frame->rows ||
         pl_coverage_pixel(frame->meshes, (int)(pixel[0] + 0.5), (int)(pixel[1] + 0.5));
}
