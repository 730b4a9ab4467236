/* Automatic exposure, measured on a small image of the frame. */
#include "frame/renderer.h"

#include "frame/effects.h"
#include "math/color.h"
#include "plan/effects.h"
#include "sensor/metering.h"
#include "trace/height_field.h"

/* Longer side of the metering image in pixels, and its samples per pixel. */
enum { METER_SIDE = 96, METER_SAMPLES = 4 };

typedef struct meter {
  float *luminances; /* one per pixel */
  float *signals;    /* one per pixel, as the sensor's pixels measure them; NULL: not needed */
  int width;
  const pl_sensor *sensor; /* for the signals */
  double response[3];      /* response to each band, relative to the response to white light */
} meter;

/* Returns a sensor pixel's signal as the radiance of white light that would give the same signal in
 * the pixels that saturate first. */
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
  pl_sensor second = *sensor; /* the ratio does not depend on the exposure time */
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

/* Effects that are not metered: light on its way over other surfaces, motion, and what is below the
 * accuracy of so small an image. */
static const size_t unmetered[] = {
    PL_EFFECT_INDEX_soft_sun,     PL_EFFECT_INDEX_limb_darkening, PL_EFFECT_INDEX_bounces,
    PL_EFFECT_INDEX_body_bounces, PL_EFFECT_INDEX_planetshine,    PL_EFFECT_INDEX_caustics,
    PL_EFFECT_INDEX_transmission, PL_EFFECT_INDEX_motion_blur,    PL_EFFECT_INDEX_rolling_shutter,
};

/* Plans the small image. The exposure is not known yet: only effects that change nothing at any
 * exposure are left out. Effects that the user forces on or off are metered as all others, so that
 * the exposure does not depend on them. */
static pl_status plan_metering(pl_view view, pl_plan *out) {
  pl_plan_wish wish = {.tolerance_dn = 0.0};
  for (size_t i = 0; i < sizeof unmetered / sizeof unmetered[0]; i++)
    pl_effect_set_add(&wish.force_off, unmetered[i]);
  return pl_plan_solve(pl_effects, pl_effect_count, &view, &wish, out);
}

pl_status pl_frame_meter(pl_renderer *renderer, const pl_frame_request *request,
                         const pl_survey *survey, double fallback, double *white_radiance,
                         pl_sensor *sensor) {
  pl_survey small = *survey;
  shrink_camera(&small.shot.rays.camera);
  const pl_camera *camera = &small.shot.rays.camera;
  const size_t count = (size_t)camera->width * (size_t)camera->height;
  const bool exposes = sensor != NULL && sensor->auto_time.on;
  meter meter = {.luminances = pl_arena_alloc(&renderer->arena, count, sizeof(float)),
                 .width = camera->width};
  if (meter.luminances == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for metering");
  if (exposes)
    PL_TRY(meter_sensor(&meter, sensor, count, &renderer->arena));
  pl_plan plan;
  small.view.white_radiance = small.view.display_white = fallback;
  small.view.sky.white_radiance = fallback;
  small.view.max_bounces = 0;
  PL_TRY(plan_metering(small.view, &plan));
  const pl_choice choice = pl_choice_of_metering(request, &plan, METER_SAMPLES);
  const size_t grounds = pl_ground_scenes(renderer->accelerators);
  const pl_instant *instant;
  PL_TRY(pl_realise(renderer->accelerators, &small, &choice, &renderer->arena, &instant));
  PL_TRY(pl_frame_render(renderer, request, instant, &small.sky, meter_tile, &meter));
  pl_ground_scenes_release(renderer->accelerators, grounds);
  if (exposes)
    pl_sensor_expose(sensor, pl_sensor_meter(&sensor->auto_time, meter.signals, camera->width,
                                             camera->height, meter.signals + count, fallback));
  if (request->exposure.automatic)
    *white_radiance = pl_exposure_meter(&request->exposure, meter.luminances, count, fallback);
  return PL_OK;
}
