/* Automatic exposure: what a small image of the frame says about its brightness. */
#include "frame/renderer.h"

#include "math/color.h"
#include "sensor/metering.h"

/* Longer side of the metering pass, pixels, and its samples. */
enum { METER_SIDE = 96, METER_SAMPLES = 4 };

typedef struct meter {
  float *luminances; /* one per pixel */
  float *signals;    /* likewise, in the sensor's pixels; NULL: not wanted */
  int width;
  const pl_sensor *sensor; /* of the signals */
  double response[3];      /* to the bands, of that to white light */
} meter;

/* What a pixel of the sensor says of its light: the radiance of a white light that would fill the
 * pixels that fill first as much. */
static float signal_of(const meter *meter, pl_vec3f light, int x, int y) {
  const pl_sensor *sensor = meter->sensor;
  const double *r = meter->response;
  if (sensor->mosaic == PL_MOSAIC_MONO)
    return (float)(r[0] * light.x + r[1] * light.y + r[2] * light.z);
  const int band = pl_sensor_band(sensor->mosaic, x, y);
  const double seen[3] = {light.x, light.y, light.z}, *mix = sensor->mix[band];
  const double sum =
      sensor->mixed ? mix[0] * seen[0] + mix[1] * seen[1] + mix[2] * seen[2] : seen[band];
  return (float)(r[band] * sum);
}

static pl_status meter_sensor(meter *meter, const pl_sensor *sensor, size_t count,
                              pl_arena *arena) {
  pl_sensor second = *sensor; /* the ratio is of any time */
  second.exposure_s = 1.0;
  meter->sensor = sensor;
  for (int band = 0; band < 3; band++)
    meter->response[band] = pl_sensor_response(&second, band) / pl_sensor_response_white(&second);
  meter->signals = pl_arena_alloc(arena, 2 * count, sizeof(float));
  return meter->signals != NULL ? PL_OK : pl_fail(PL_E_MEMORY, "out of memory for metering");
}

static pl_status meter_tile(void *context, const pl_tile_result *result, int worker) {
  (void)worker;
  meter *meter = context;
  for (int j = 0; j < result->tile.height; j++)
    for (int i = 0; i < result->tile.width; i++) {
      const int x = result->tile.x0 + i, y = result->tile.y0 + j;
      const size_t pixel = (size_t)y * (size_t)meter->width + (size_t)x;
      const pl_vec3f light = result->radiance[j * PL_TILE_SIDE + i];
      meter->luminances[pixel] = pl_luminance(light);
      if (meter->signals != NULL)
        meter->signals[pixel] = signal_of(meter, light, x, y);
    }
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

/* Value of the rows of veils for a quick look. */
enum { QUICK_VEILS = 4 };

pl_status pl_frame_veils(pl_arena *arena, const pl_snapshot *shot, const pl_plan *plan,
                         pl_veils *veils, pl_render_settings *settings) {
  int values[PL_VEIL_KINDS_MAX];
  bool any;
  for (size_t k = 0; k < pl_veil_kind_count; k++)
    values[k] = plan != NULL ? pl_plan_value(plan, pl_veil_kinds[k]->name) : QUICK_VEILS;
  PL_TRY(pl_veils_build(shot, values, settings->air, arena, veils, &any));
  veils->emission = plan == NULL || pl_plan_value(plan, "emission") > 0;
  settings->veils = any ? veils : NULL;
  return PL_OK;
}

pl_status pl_frame_planetshine(pl_arena *arena, const pl_snapshot *shot, const pl_plan *plan,
                               pl_planetshine *shine, pl_render_settings *settings) {
  settings->shine = NULL;
  if (pl_plan_value(plan, "planetshine") == 0 || shot->body_count == 0)
    return PL_OK;
  PL_TRY(pl_planetshine_build(shot, settings, arena, shine));
  settings->shine = shine->any ? shine : NULL;
  return PL_OK;
}

void pl_frame_caustics(const pl_renderer *renderer, const pl_snapshot *shot, const pl_plan *plan,
                       pl_caustics *caustics, pl_render_settings *settings) {
  settings->caustics = NULL;
  if (settings->samples == 0 || pl_plan_value(plan, "caustics") == 0 || settings->bounces == 0)
    return;
  pl_caustics_build(shot, renderer->tracer, settings->detail, caustics);
  settings->caustics = caustics->count > 0 ? caustics : NULL;
}

pl_status pl_frame_meter(pl_renderer *renderer, const pl_frame_request *request,
                         const pl_snapshot *shot, double fallback, double *white_radiance,
                         pl_sensor *sensor) {
  pl_snapshot small = *shot;
  shrink_camera(&small.camera);
  const size_t count = (size_t)small.camera.width * (size_t)small.camera.height;
  const bool exposes = sensor != NULL && sensor->auto_time.on;
  meter meter = {.luminances = pl_arena_alloc(&renderer->arena, count, sizeof(float)),
                 .width = small.camera.width};
  if (meter.luminances == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for metering");
  if (exposes)
    PL_TRY(meter_sensor(&meter, sensor, count, &renderer->arena));
  pl_render_settings settings = {.seed = request->seed,
                                 .frame = request->index,
                                 .samples = METER_SAMPLES,
                                 .cast_shadows = true,
                                 .emission = true,
                                 .detail = PL_DETAIL_FULL,
                                 .clear_coat = true};
  pl_emitters emitters;
  pl_air_view air;
  pl_veils veils;
  PL_TRY(pl_frame_air(&renderer->arena, &small, NULL, &air, &settings));
  PL_TRY(pl_frame_veils(&renderer->arena, &small, NULL, &veils, &settings));
  PL_TRY(pl_frame_emitters(&renderer->arena, &small, 2, &emitters, &settings));
  PL_TRY(pl_tracer_set(renderer->tracer, &small));
  PL_TRY(pl_render(&small, renderer->tracer, &settings, renderer->scratch, meter_tile, &meter,
                   request->cancel));
  if (exposes)
    pl_sensor_expose(sensor, pl_sensor_meter(&sensor->auto_time, meter.signals, small.camera.width,
                                             small.camera.height, meter.signals + count, fallback));
  if (request->exposure.automatic)
    *white_radiance = pl_exposure_meter(&request->exposure, meter.luminances, count, fallback);
  return PL_OK;
}
