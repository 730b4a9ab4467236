/* Where the sun's limb crosses a pixel, a thousandth of the disc is white, and fewer samples miss
 * slivers of it. Where every pixel has the frame's samples, those of such pixels therefore look for
 * the sun along more rays than their own, which do nothing else. */
#include "light/sun.h"
#include "render/path.h"

bool pl_path_on_limb(const pl_path_context *context, uint32_t pixel) {
  if (!context->sun)
    return false;
  const pl_sun_view *sun = &context->camera_sun;
  const int x = context->tile.x0 + (int)(pixel % PL_TILE_SIDE);
  const int y = context->tile.y0 + (int)(pixel / PL_TILE_SIDE);
  const pl_vec3 ray = pl_snapshot_ray(context->shot, x, y);
  const pl_vec3 toward = pl_vec3f_to_double(sun->direction);
  const double off = pl_vec3_norm(pl_vec3_cross(ray, toward));
  /* Rays through the rim of a lens point away from that through its centre. */
  const double far_m = (double)sun->distance_m;
  const double lens = 0.5 * pl_image_confusion_m(context->shot, ray, far_m) / far_m;
  return pl_vec3_dot(ray, toward) > 0.0 &&
         fabs(off - (double)sun->sin_radius) < context->pixel_rad + lens;
}

int pl_path_limb_rays(const pl_path_context *context, uint32_t pixel) {
  const int samples = context->settings->samples;
  /* Adaptive frames have more samples there. */
  if (context->filters_irradiance || !pl_path_on_limb(context, pixel))
    return 0;
  return PL_SUN_LIMB_SAMPLES / samples > 1 ? PL_SUN_LIMB_SAMPLES / samples : 0;
}

/* The part of its light that reaches the camera along a ray that meets no surface. */
static pl_vec3f passed(const pl_path_context *context, const pl_ray *ray) {
  const pl_beam beam = {
      .origin = ray->origin, .direction = ray->direction, .spread = context->spread};
  return pl_media_passed(context->media ? context->settings->media : NULL,
                         context->air ? context->settings->air : NULL, context->shot, &beam,
                         INFINITY);
}

/* Adds the light of the rays that nothing stops. */
static void trace(const pl_path_context *context, size_t count, pl_tile_buffers *b) {
  pl_tracer_occluded(context->tracer, b->shadow_rays, b->occluded, count, true);
  for (size_t i = 0; i < count; i++)
    if (!b->occluded[i]) {
      pl_vec3f *sum = &b->sample[b->pending[i].pixel];
      const pl_vec3f light =
          pl_vec3f_mul(passed(context, &b->shadow_rays[i]), b->pending[i].radiance);
      *sum = pl_vec3f_add(*sum, light);
    }
}

/* Queues the ray at a position of a pixel if it meets the disc. */
static size_t look(const pl_path_context *context, uint32_t pixel, uint32_t index, int rays,
                   size_t queued, pl_tile_buffers *b) {
  const pl_sun_view *sun = &context->camera_sun;
  const pl_limb *limb = context->settings->limb;
  double offset[2];
  pl_image_sample_offset(index, rays * context->settings->samples, offset);
  const int x = context->tile.x0 + (int)(pixel % PL_TILE_SIDE);
  const int y = context->tile.y0 + (int)(pixel / PL_TILE_SIDE);
  pl_vec3 origin, ray;
  pl_image_sample_ray(context->shot, index, offset, x, y, b->seeds[pixel], &origin, &ray);
  const pl_vec3f direction = pl_vec3_to_float(ray);
  if (!pl_sun_covers(sun, direction))
    return queued;
  const float light = sun->radiance / (float)rays;
  const pl_vec3f even = {light, light, light};
  b->shadow_rays[queued] = (pl_ray){.origin = origin,
                                    .t_max = INFINITY,
                                    .direction = ray,
                                    .skip_body = PL_NO_BODY,
                                    .from_surface = PL_NO_SURFACE};
  b->pending[queued] = (pl_pending){
      .radiance = limb != NULL ? pl_vec3f_scale(pl_limb_ratio(limb, sun, direction), light) : even,
      .pixel = pixel};
  return queued + 1;
}

void pl_path_see_limb(const pl_path_context *context, uint32_t index, pl_tile_buffers *b) {
  size_t queued = 0;
  if (!context->sun)
    return;
  for (size_t i = 0; i < b->active_count; i++) {
    const uint32_t pixel = b->active[i];
    const int rays = pl_path_limb_rays(context, pixel);
    for (int k = 0; k < rays; k++) {
      queued = look(context, pixel, index * (uint32_t)rays + (uint32_t)k, rays, queued, b);
      if (queued == PL_TILE_SHADOWS) {
        trace(context, queued, b);
        queued = 0;
      }
    }
  }
  trace(context, queued, b);
}
