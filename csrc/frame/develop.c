/* From the radiance of a frame to its sensor's arrays. */
#include "frame/renderer.h"
#include "sensor/stage.h"

bool pl_frame_wants_sensor(const pl_frame_request *request) {
  return request->raw != NULL || request->sensor_rgb != NULL;
}

pl_status pl_frame_develop(pl_renderer *renderer, const pl_frame_request *request,
                           const pl_sensor *sensor, const pl_plan *plan, pl_vec3f *bands) {
  const pl_camera *camera = &request->placement.camera;
  const size_t pixels = (size_t)camera->width * (size_t)camera->height;
  pl_sensor_frame frame = {
      .sensor = sensor,
      .width = camera->width,
      .height = camera->height,
      .focal_px = {camera->fx, camera->fy},
      .centre_px = {camera->cx, camera->cy},
      .seed = request->seed,
      .index = request->index,
      .threads = request->threads,
      .cancel = request->cancel,
      .arena = &renderer->arena,
      .bands = bands,
      .electrons = pl_arena_alloc(&renderer->arena, pixels, sizeof(double)),
      .raw = request->raw,
      .rgb = request->sensor_rgb,
      .encoder = &renderer->encoder,
  };
  if (frame.raw == NULL)
    frame.raw = pl_arena_alloc(&renderer->arena, pixels, sizeof *frame.raw);
  if (frame.electrons == NULL || frame.raw == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for a sensor's image");
  return pl_sensor_run(&frame, plan);
}
