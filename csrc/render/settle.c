/* Pixels whose colour needs no sampling: the middle of a body, away from terminator and shadow. A
 * Lambert surface under a sun that is wholly above (or below) the horizon has a closed form, and
 * the map is filtered over the pixel's footprint, so one shading is the pixel's mean. */
#include <string.h>

#include "light/sun.h"
#include "render/path.h"
#include "shade/reflectance.h"

/* The whole disc clears the horizon when the sun is higher than its radius; the rest allows for
 * the change of the normal across a pixel. */
static const float HORIZON_MARGIN = 3.0f;
/* Towards the limb a pixel's footprint grows until one value is no mean any more: the view must be
 * this steep, and the footprint this short against the body's radius. */
static const float COSINE_MIN = 0.15f, ARC_MAX_RAD = 0.01f;

/* Radiance of the body at the pixel's centre for the pixel as a whole; false if it must be sampled.
 */
static bool settle_pixel(const pl_path_context *context, uint32_t pixel, pl_tile_buffers *b) {
  const pl_snapshot *shot = context->shot;
  pl_vertex vertex = b->points[pixel];
  if (vertex.thing == PL_NOTHING || vertex.thing < shot->object_count)
    return false;
  const pl_shot_body *body = &shot->bodies[vertex.thing - shot->object_count];
  const pl_render_settings *settings = context->settings;
  if (body->body->reflectance != &pl_reflectance_lambert || settings->body_bounces ||
      (settings->cast_shadows && body->shadowed))
    return false;
  const pl_vec3f toward = pl_vec3_to_float(pl_vec3_unit(vertex.position));
  const float cosine = fabsf(pl_vec3f_dot(toward, vertex.ng));
  const double footprint_m = vertex.t * context->pixel_rad / fmaxf(cosine, COSINE_MIN);
  const pl_vec3 radii = body->state->radii_m;
  if (cosine < COSINE_MIN || footprint_m > ARC_MAX_RAD * fmin(radii.x, fmin(radii.y, radii.z)))
    return false;
  const pl_sun_view sun = pl_sun_view_at(&shot->sun, vertex.position);
  const float height = pl_vec3f_dot(sun.direction, vertex.ng);
  if (fabsf(height) < HORIZON_MARGIN * sun.sin_radius)
    return false;
  const pl_beam beam = {
      .direction = pl_vec3_unit(vertex.position),
      .spread = (float)context->pixel_rad,
  };
  pl_vertex_shade(shot, &beam, settings->surface_maps, &vertex);
  const float irradiance = height > 0.0f ? height * sun.irradiance : 0.0f;
  b->settled[pixel] =
      pl_vec3f_madd(vertex.surface.emission, irradiance / PL_PI_F, vertex.surface.color);
  return true;
}

/* Whether the corners of each pixel lie on the tile's only body: its outline is convex, so the
 * pixel does too. */
static void cover_pixels(const pl_path_context *context, bool covered[PL_TILE_PIXELS]) {
  enum { CORNERS = PL_TILE_SIDE + 1 };
  pl_ray ray = {.t_max = INFINITY, .skip_body = PL_NOTHING};
  bool corner[CORNERS][CORNERS];
  for (int y = 0; y <= context->tile.height; y++)
    for (int x = 0; x <= context->tile.width; x++) {
      pl_hit hit;
      ray.direction = pl_vec3_to_float(
          pl_snapshot_ray(context->shot, context->tile.x0 + x - 0.5, context->tile.y0 + y - 0.5));
      pl_tracer_closest(context->tracer, &ray, &hit, 1, false, false);
      corner[y][x] = hit.thing != PL_NOTHING;
    }
  for (int y = 0; y < context->tile.height; y++)
    for (int x = 0; x < context->tile.width; x++)
      covered[y * PL_TILE_SIDE + x] =
          corner[y][x] && corner[y][x + 1] && corner[y + 1][x] && corner[y + 1][x + 1];
}

void pl_path_settle(const pl_path_context *context, pl_tile_buffers *b) {
  const bool alone = !context->meshes && context->body != PL_NOTHING;
  bool covered[PL_TILE_PIXELS];
  if (alone)
    cover_pixels(context, covered);
  b->active_count = 0;
  memset(b->square, 0, sizeof b->square);
  memset(b->sample, 0, sizeof b->sample);
  for (int y = 0; y < context->tile.height; y++) {
    for (int x = 0; x < context->tile.width; x++) {
      const uint32_t pixel = (uint32_t)(y * PL_TILE_SIDE + x);
      const bool settled = settle_pixel(context, pixel, b);
      b->settled_thing[pixel] = settled ? b->points[pixel].thing : PL_NOTHING;
      const bool done = settled && alone && covered[pixel];
      b->counts[pixel] = done ? 1 : 0;
      if (done)
        b->radiance[pixel] = b->settled[pixel];
      else
        b->active[b->active_count++] = pixel;
    }
  }
}
