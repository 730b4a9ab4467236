#include "render/sun_ray.h"

/* Across an object the sun's direction changes by the object's size over the sun's distance, which
 * is negligible unless the object is as large as a body. */
pl_sun_view pl_sun_view_of(const pl_snapshot *shot, const pl_sun_view *suns,
                           const pl_vertex *vertex) {
  const double negligible = 1e-6;
  if (pl_surface_is_mesh(vertex->surface_id)) {
    const pl_sun_view *sun = &suns[pl_surface_index(vertex->surface_id)];
    if (pl_shot_object_of(shot, vertex->surface_id)->radius_m < negligible * sun->distance_m)
      return *sun;
  }
  return pl_sun_view_at(&shot->sun, vertex->position);
}

pl_ray pl_sun_ray(const pl_vertex *vertex, const pl_snapshot *shot, const pl_sun_view *sun,
                  pl_vec3f toward) {
  /* Ends at the sun's surface, less a margin for rounding, so that a body that represents the sun
   * does not occlude it. */
  const float reach = sun->distance_m * (1.0f - sun->sin_radius) * 0.999999f;
  pl_ray ray = pl_vertex_ray(vertex, shot, toward, reach);
  if (pl_surface_is_mesh(vertex->surface_id) &&
      !pl_shot_object_of(shot, vertex->surface_id)->eclipsed)
    ray.skip_body = PL_EVERY_ELLIPSOID;
  return ray;
}
