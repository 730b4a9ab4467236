/* Converts the radiance of a frame to its sensor's arrays. */
#include "frame/renderer.h"

#include <string.h>

#include "io/jpeg_write.h"
#include "light/sun.h"
#include "math/sampling.h"
#include "plan/effects.h"
#include "sensor/stage.h"

bool pl_frame_wants_sensor(const pl_frame_request *request) {
  return request->raw != NULL || request->sensor_rgb != NULL || request->glare != NULL;
}

/* Rays that measure the visible part of the sun: 8 x 8 over its disc. */
enum { SUN_SIDE = 8, SUN_RAYS = SUN_SIDE * SUN_SIDE };

/* Returns the fraction of the sun's disc that is visible from the camera. Whatever the plan
 * culled hides nothing. */
static double sun_seen(const pl_tracer *tracer, const pl_sun_view *sun) {
  pl_ray rays[SUN_RAYS];
  pl_hit hits[SUN_RAYS];
  int seen = 0;
  for (int i = 0; i < SUN_RAYS; i++) {
    const float u[2] = {((float)(i % SUN_SIDE) + 0.5f) / SUN_SIDE,
                        ((float)(i / SUN_SIDE) + 0.5f) / SUN_SIDE};
    rays[i] = (pl_ray){.t_max = sun->distance_m,
                       .direction = pl_vec3_unit(pl_vec3f_to_double(pl_sun_sample(sun, u))),
                       .skip_body = PL_NO_BODY};
  }
  pl_tracer_closest(tracer, rays, hits, SUN_RAYS, true, true); /* with the camera's visibility */
  for (int i = 0; i < SUN_RAYS; i++)
    seen += pl_surface_is_none(hits[i].surface_id);
  return (double)seen / SUN_RAYS;
}

/* The sun as a source of ghosts. Irradiance on the aperture is proportional to the cosine of the
 * angle of incidence. */
static pl_flare_sun flare_sun(const pl_instant *instant, const pl_flare *flare) {
  const pl_snapshot *shot = &instant->shot;
  const pl_camera *camera = &shot->rays.camera;
  const pl_vec3 to_sun = pl_mat3_mul_vec_t(shot->camera_to_root, pl_vec3_unit(shot->sun.position));
  const double angle = acos(fmax(-1.0, fmin(1.0, to_sun.z)));
  const double part = pl_flare_baffle(flare, angle) * fmax(0.0, to_sun.z);
  pl_flare_sun out = {.on = false};
  if (!(part > 0.0) || !pl_camera_project(camera, to_sun, out.place_px))
    return out;
  const pl_sun_view sun = pl_sun_view_at(&shot->sun, (pl_vec3){0.0, 0.0, 0.0});
  out.light = part * sun.irradiance * camera->fx * camera->fy * sun_seen(instant->tracer, &sun);
  out.radius_px = sun.sin_radius * fmax(camera->fx, camera->fy) / pow(to_sun.z, 2.0);
  out.on = out.light > 0.0;
  return out;
}

/* Runs one image through the stages of the sensor; `raw` may be NULL. */
static pl_status run(pl_renderer *renderer, const pl_frame_request *request,
                     const pl_instant *instant, const pl_sensor *sensor, const pl_plan *plan,
                     pl_vec3f *bands, uint16_t *raw, uint64_t index) {
  const pl_camera *camera = &request->placement.camera;
  const size_t pixels = (size_t)camera->width * (size_t)camera->height;
  pl_arena_reset(&renderer->sensor_arena);
  pl_sensor_frame frame = {
      .sensor = sensor,
      .width = camera->width,
      .height = camera->height,
      .focal_px = {camera->fx, camera->fy},
      .centre_px = {camera->cx, camera->cy},
      .seed = request->seed,
      .index = index,
      .threads = request->threads,
      .cancel = request->cancel,
      .arena = &renderer->sensor_arena,
      .bands = bands,
      .electrons = pl_arena_alloc(&renderer->sensor_arena, pixels, sizeof(double)),
      .raw = raw,
      .rgb = request->sensor_rgb,
      .glare = request->glare,
      .encoder = &renderer->encoder,
  };
  if (pl_plan_value(plan, &pl_effect_lens_flare) > 0)
    frame.sun = flare_sun(instant, &sensor->flare);
  if (frame.raw == NULL)
    frame.raw = pl_arena_alloc(&renderer->sensor_arena, pixels, sizeof *frame.raw);
  if (frame.electrons == NULL || frame.raw == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for a sensor's image");
  PL_TRY(pl_sensor_run(&frame, plan));
  if (frame.rgb == NULL || pl_plan_value(plan, &pl_effect_compression) == 0)
    return PL_OK;
  return pl_jpeg_cycle(&sensor->compression, frame.width, frame.height, frame.arena, frame.rgb);
}

/* Runs one image per plane: the same light and pixels, with independent noise. */
static pl_status run_planes(pl_renderer *renderer, const pl_frame_request *request,
                            const pl_instant *instant, const pl_sensor *sensor, const pl_plan *plan,
                            const pl_vec3f *bands) {
  const pl_camera *camera = &request->placement.camera;
  const size_t pixels = (size_t)camera->width * (size_t)camera->height, count = sensor->plane_count;
  pl_vec3f *light = pl_arena_alloc(&renderer->arena, pixels, sizeof *light);
  uint16_t *raw = pl_arena_alloc(&renderer->arena, pixels, sizeof *raw);
  if (light == NULL || raw == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for a sensor's image");
  for (size_t plane = 0; plane < count; plane++) {
    const pl_sensor filtered = pl_sensor_of_plane(sensor, plane);
    memcpy(light, bands, pixels * sizeof *light);
    /* frames have indices below 2^31 */
    PL_TRY(run(renderer, request, instant, &filtered, plan, light, raw,
               request->index + ((uint64_t)plane << 48)));
    for (size_t i = 0; i < pixels; i++)
      request->raw[i * count + plane] = raw[i];
  }
  return PL_OK;
}

pl_status pl_frame_develop(pl_renderer *renderer, const pl_frame_request *request,
                           const pl_instant *instant, const pl_sensor *sensor, const pl_plan *plan,
                           pl_vec3f *bands) {
  if (sensor->plane_count > 0)
    return run_planes(renderer, request, instant, sensor, plan, bands);
  return run(renderer, request, instant, sensor, plan, bands, request->raw, request->index);
}
