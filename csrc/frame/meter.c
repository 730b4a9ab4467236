/* Automatic exposure: what a small image of the frame says about its brightness. */
#include "frame/renderer.h"

#include "math/color.h"

/* Longer side of the metering pass, pixels, and its samples. */
enum { METER_SIDE = 96, METER_SAMPLES = 4 };

typedef struct meter {
  float *luminances; /* one per pixel */
  int width;
} meter;

static pl_status meter_tile(void *context, const pl_tile_result *result, int worker) {
  (void)worker;
  meter *meter = context;
  for (int y = 0; y < result->tile.height; y++)
    for (int x = 0; x < result->tile.width; x++)
      meter->luminances[(size_t)(result->tile.y0 + y) * (size_t)meter->width +
                        (size_t)(result->tile.x0 + x)] =
          pl_luminance(result->radiance[y * PL_TILE_SIDE + x]);
  return PL_OK;
}

static void shrink_camera(pl_camera *camera) {
  const int side = camera->width > camera->height ? camera->width : camera->height;
  if (side <= METER_SIDE)
    return;
  const double s = (double)METER_SIDE / side;
  const int w = (int)fmax(1.0, s * camera->width + 0.5);
  const int h = (int)fmax(1.0, s * camera->height + 0.5);
  const double sx = (double)w / camera->width, sy = (double)h / camera->height;
  camera->fx *= sx;
  camera->skew *= sx;
  camera->fy *= sy;
  camera->cx = (camera->cx + 0.5) * sx - 0.5;
  camera->cy = (camera->cy + 0.5) * sy - 0.5;
  camera->width = w;
  camera->height = h;
}

pl_status pl_frame_emitters(pl_arena *arena, const pl_snapshot *shot, int wanted,
                            pl_emitters *emitters, pl_render_settings *settings) {
  if (wanted == 0)
    return PL_OK;
  PL_TRY(pl_emitters_build(shot, settings->detail, arena, emitters));
  settings->emitters = emitters->count > 0 ? emitters : NULL;
  settings->emitters_on_bodies = emitters->count > 0 && wanted > 1;
  return PL_OK;
}

/* Steps of a quick look at the air: its error is of a few per cent. */
enum { QUICK_STEPS = 6 };

pl_status pl_frame_air(pl_arena *arena, const pl_snapshot *shot, const pl_plan *plan,
                       pl_air_view *air, pl_render_settings *settings) {
  const int steps = plan != NULL ? pl_plan_value(plan, "atmosphere") : QUICK_STEPS;
  if (steps == 0)
    return PL_OK;
  PL_TRY(pl_air_view_build(shot, steps, arena, air));
  air->skylight = plan == NULL || pl_plan_value(plan, "skylight") > 0;
  air->multiple = plan == NULL || pl_plan_value(plan, "multiple_scattering") > 0;
  settings->air = air->count > 0 ? air : NULL;
  return PL_OK;
}

pl_status pl_frame_meter(pl_renderer *renderer, const pl_frame_request *request,
                         const pl_snapshot *shot, double fallback, double *white_radiance,
                         pl_sensor *sensor) {
  pl_snapshot small = *shot;
  shrink_camera(&small.camera);
  const size_t count = (size_t)small.camera.width * (size_t)small.camera.height;
  meter meter = {pl_arena_alloc(&renderer->arena, count, sizeof(float)), small.camera.width};
  if (meter.luminances == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for metering");
  pl_render_settings settings = {.seed = request->seed,
                                 .frame = request->index,
                                 .samples = METER_SAMPLES,
                                 .cast_shadows = true,
                                 .emission = true,
                                 .detail = PL_DETAIL_FULL,
                                 .clear_coat = true};
  pl_emitters emitters;
  pl_air_view air;
  PL_TRY(pl_frame_air(&renderer->arena, &small, NULL, &air, &settings));
  PL_TRY(pl_frame_emitters(&renderer->arena, &small, 2, &emitters, &settings));
  PL_TRY(pl_tracer_set(renderer->tracer, &small));
  PL_TRY(pl_render(&small, renderer->tracer, &settings, renderer->scratch, meter_tile, &meter,
                   request->cancel));
  if (request->exposure.automatic)
    *white_radiance = pl_exposure_meter(&request->exposure, meter.luminances, count, fallback);
  if (sensor != NULL && sensor->auto_time.on) {
    const pl_exposure exposure = {.percentile = sensor->auto_time.percentile,
                                  .key = sensor->auto_time.key};
    sensor->exposure_s = pl_sensor_auto_time_s(
        sensor, pl_exposure_meter(&exposure, meter.luminances, count, fallback));
  }
  return PL_OK;
}
