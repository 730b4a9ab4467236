#include "render/shadow_mask.h"

#include "render/geometry.h"
#include "render/sun_ray.h"

/* The sine of the sun's angular radius on its own surface, less rounding. */
static const float OWN_SURFACE = 0.999f;

/* Makes the ray that decides whether a point is in shadow; false if that is known without, and set.
 */
static bool ray_of(const pl_path_context *context, pl_point *point, pl_ray *out) {
  const pl_snapshot *shot = context->shot;
  const pl_geometry_kind *kind = pl_geometry_of(point->surface_id);
  point->in_shadow = true;
  point->shadow_cause = PL_SHADOW_BODY;
  if (pl_surface_is_mesh(point->surface_id) && pl_shot_object_of(shot, point->surface_id)->dark)
    return false;
  point->shadow_cause = PL_SHADOW_SELF;
  pl_vertex vertex = pl_point_vertex(point);
  if (kind->set_horizon != NULL)
    kind->set_horizon(shot, &vertex);
  const pl_sun_view sun = pl_sun_view_of(shot, context->suns, &vertex);
  if (sun.sin_radius > OWN_SURFACE) { /* a body that represents the sun */
    point->in_shadow = false;
    point->shadow_cause = PL_SHADOW_NONE;
    return false;
  }
  if (!(pl_vec3f_dot(vertex.surface.ng, sun.direction) > 0.0f))
    return false;
  *out = pl_sun_ray(&vertex, shot, &sun, sun.direction);
  return true;
}

static pl_shadow_cause cause_of(pl_surface_id point, pl_surface_id met) {
  if (pl_surface_is_none(met)) /* by rounding at its end: what lies next to the point */
    return PL_SHADOW_SELF;
  switch (pl_surface_kind_of(met)) {
  case PL_SURFACE_HEIGHT_FIELD:
  case PL_SURFACE_ROCKS:
    return PL_SHADOW_GROUND;
  case PL_SURFACE_MESH:
    return pl_surface_same(point, met) ? PL_SHADOW_SELF : PL_SHADOW_OBJECT;
  default:
    return pl_surface_same(point, met) ? PL_SHADOW_SELF : PL_SHADOW_BODY;
  }
}

/* Follows the light, since faces exist as seen from it. */
static void find_cause(const pl_path_context *context, const pl_ray *to_sun, pl_point *point) {
  pl_ray light = *to_sun;
  pl_hit hit;
  light.origin = pl_vec3_madd(to_sun->origin, to_sun->t_max, to_sun->direction);
  light.direction = pl_vec3_scale(to_sun->direction, -1.0);
  light.leaves = 0.0f;
  pl_tracer_closest(context->tracer, &light, &hit, 1, false, true);
  point->shadow_cause = (uint8_t)cause_of(point->surface_id, hit.surface_id);
}

void pl_shadow_mask(const pl_path_context *context, pl_tile_buffers *b) {
  size_t count = 0;
  for (int y = 0; y < context->tile.height; y++)
    for (int x = 0; x < context->tile.width; x++) {
      const uint32_t pixel = (uint32_t)(y * PL_TILE_SIDE + x);
      pl_point *point = &b->points[pixel];
      if (!pl_surface_is_none(point->surface_id) && ray_of(context, point, &b->shadow_rays[count]))
        b->wave_seeds[count++] = pixel;
    }
  /* Ray by ray: packets would depend on what their neighbours see. */
  pl_tracer_occluded(context->tracer, b->shadow_rays, b->occluded, count, false);
  for (size_t i = 0; i < count; i++) {
    pl_point *point = &b->points[b->wave_seeds[i]];
    point->in_shadow = b->occluded[i];
    point->shadow_cause = PL_SHADOW_NONE;
    if (b->occluded[i] && context->settings->shadow_cause)
      find_cause(context, &b->shadow_rays[i], point);
  }
}
