/* Renders one frame from request to arrays. */
#include "frame/frame.h"

#include <string.h>
#include <time.h>

#include "base/memory.h"
#include "frame/subpixel_bodies.h"
#include "frame/effects.h"
#include "frame/flow.h"
#include "frame/height_fields.h"
#include "frame/moving.h"
#include "frame/output.h"
#include "frame/renderer.h"
#include "scene/shutter.h"
#include "sensor/stage.h"
#include "trace/height_field.h"

static const char *const stage_names[PL_STAGE_COUNT] = {"snapshot", "meter", "plan",  "realise",
                                                        "render",   "label", "sensor"};

const char *pl_stage_name(pl_stage stage) { return stage_names[stage]; }

static double now_s(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Adds the time since *start to a stage and restarts the clock. */
static void lap(pl_frame_result *result, pl_stage stage, double *start) {
  const double now = now_s();
  result->seconds[stage] += now - *start;
  *start = now;
}

pl_status pl_renderer_create(const pl_scene *scene, pl_renderer **out) {
  void *memory;
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_renderer), "a renderer", &memory));
  pl_renderer *renderer = memory;
  renderer->scene = scene;
  pl_arena_init(&renderer->arena);
  pl_arena_init(&renderer->sensor_arena);
  pl_arena_init(&renderer->instants);
  pl_encoder_init(&renderer->encoder);
  pl_label_tools_init(&renderer->label_tools);
  const pl_status status = pl_accelerators_create(&renderer->accelerators);
  if (status != PL_OK)
    pl_renderer_destroy(renderer);
  else
    *out = renderer;
  return status;
}

void pl_renderer_destroy(pl_renderer *renderer) {
  if (renderer == NULL)
    return;
  pl_label_tools_clear(&renderer->label_tools);
  pl_accelerators_destroy(renderer->accelerators);
  pl_render_scratch_destroy(renderer->scratch);
  pl_arena_clear(&renderer->arena);
  pl_arena_clear(&renderer->sensor_arena);
  pl_arena_clear(&renderer->instants);
  pl_free(renderer);
}

/* Allocates scratch memory for exactly this many workers. */
static pl_status ensure_scratch(pl_renderer *renderer, int threads) {
  if (renderer->scratch != NULL && pl_render_scratch_threads(renderer->scratch) == threads)
    return PL_OK;
  pl_render_scratch_destroy(renderer->scratch);
  renderer->scratch = NULL;
  return pl_render_scratch_create(threads, &renderer->scratch);
}

static bool wants_colour(const pl_frame_request *request) {
  return request->rgb != NULL || request->radiance != NULL || request->bands != NULL ||
         pl_frame_wants_sensor(request);
}

static pl_status check_request(const pl_frame_request *request) {
  const pl_exposure *e = &request->exposure;
  if (request->samples < 1 || request->samples > 65536)
    return pl_fail(PL_E_RANGE, "samples must be in 1..65536, not %d", request->samples);
  if (request->max_bounces < 0 || request->max_bounces > 64)
    return pl_fail(PL_E_RANGE, "max_bounces must be in 0..64, not %d", request->max_bounces);
  if (request->texture_filter < PL_FILTER_NEAREST || request->texture_filter >= PL_FILTER_COUNT)
    return pl_fail(PL_E_RANGE, "texture_filter must be in 1..%d, not %d", PL_FILTER_FINEST,
                   request->texture_filter);
  if (request->placement.volume_count > 0 &&
      (request->volume_steps < 1 || request->volume_steps > 4096))
    return pl_fail(PL_E_RANGE, "volume_steps must be in 1..4096, not %d", request->volume_steps);
  if (!(request->target_dn >= 0.0 && request->target_sigmas >= 0.0))
    return pl_fail(PL_E_RANGE, "target_dn and target_sigmas must be at least 0");
  if (!(request->wish.tolerance_dn >= 0.0))
    return pl_fail(PL_E_RANGE, "tolerance_dn must be at least 0");
  if (!e->automatic && !(e->white_radiance > 0.0 && isfinite(e->white_radiance)))
    return pl_fail(PL_E_RANGE, "exposure: white_radiance must be finite and positive");
  if (e->automatic && !(e->percentile >= 0.0 && e->percentile <= 100.0 && e->key > 0.0))
    return pl_fail(PL_E_RANGE, "exposure: percentile must be in 0..100 and key positive");
  if (!(e->least_white >= 0.0 && isfinite(e->least_white)))
    return pl_fail(PL_E_RANGE, "exposure: min_white_radiance must be finite and at least 0");
  if (pl_frame_wants_sensor(request) && request->sensor == NULL)
    return pl_fail(PL_E_ARGUMENT, "a channel of the sensor is asked for, but there is no sensor");
  if (request->bands != NULL && request->band_count < 1)
    return pl_fail(PL_E_ARGUMENT, "the channel `bands` is asked for, but there are no bands");
  if (request->sensor_rgb != NULL && request->sensor->plane_count > 0)
    return pl_fail(PL_E_ARGUMENT, "a sensor of planes has no picture in colour");
  if (request->glare != NULL && request->sensor->plane_count > 0)
    return pl_fail(PL_E_ARGUMENT, "a sensor of planes has no one glare");
  return request->sensor != NULL ? pl_sensor_check(request->sensor) : PL_OK;
}

/* --- the frame -------------------------------------------------------------------------------- */

/* Returns the radiance of a white Lambert surface that faces the sun, at the entity in the frame
 * with the highest irradiance. */
static double sunlit_white(const pl_snapshot *shot, const pl_view *view) {
  double irradiance = pl_shot_sun_irradiance(&shot->sun, (pl_vec3){0.0, 0.0, 0.0});
  for (size_t i = 0; i < view->entity_count; i++)
    if (view->entities[i].in_frame)
      irradiance = fmax(irradiance, view->entities[i].irradiance);
  return fmax(irradiance / PL_PI, 1e-30);
}

/* Returns whether the image by the display's exposure counts: it, or an output without an exposure
 * of its own, is requested; or no output is, as when only a plan is made. */
static bool shows_display(const pl_frame_request *request) {
  return request->rgb != NULL || request->radiance != NULL || request->bands != NULL ||
         !pl_frame_wants_sensor(request);
}

/* Finds the radiances that the requested images show as white. whites[0] is the lowest, whites[1]
 * that of the other image, if there are two. */
static void find_whites(const pl_frame_request *request, pl_view *view, double whites[2]) {
  const double display = view->display_white = view->white_radiance;
  const double sensor = view->sensor != NULL ? pl_sensor_white_radiance(view) : INFINITY;
  const bool both = shows_display(request), developed = isfinite(sensor) && sensor > 0.0;
  whites[1] = both && developed ? fmax(display, sensor) : 0.0;
  if (developed)
    view->white_radiance = both ? fmin(display, sensor) : sensor;
  whites[0] = view->white_radiance;
}

/* Sets the exposures of the display and of the sensor (NULL: none); automatic ones are measured if
 * `metered`. */
static pl_status expose(pl_renderer *renderer, const pl_frame_request *request, bool metered,
                        pl_survey *survey, pl_sensor *sensor) {
  const bool automatic = request->exposure.automatic;
  const double fallback = sunlit_white(&survey->shot, &survey->view);
  double white = automatic ? fallback : request->exposure.white_radiance;
  if (metered && (automatic || (sensor != NULL && sensor->auto_time.on)))
    PL_TRY(pl_frame_meter(renderer, request, survey, fallback, &white, sensor));
  survey->view.white_radiance = white;
  survey->view.sensor = sensor;
  return PL_OK;
}

/* Prepares the survey of a frame, without its exposure. */
static pl_status survey_frame(pl_renderer *renderer, const pl_frame_request *request,
                              pl_survey *out) {
  const pl_sky *sky = request->sky;
  PL_TRY(check_request(request));
  PL_TRY(pl_placement_check(renderer->scene, &request->placement));
  PL_TRY(ensure_scratch(renderer, request->threads));
  pl_arena_reset(&renderer->arena);
  pl_ground_tiles_trim(renderer->accelerators);
  PL_TRY(pl_survey_place(renderer->scene, request, &request->placement, &renderer->arena, out));
  pl_shutter_measure(&request->placement, &out->shot,
                     sky != NULL && (sky->stars != NULL || sky->backdrop.kind == PL_BACKDROP_MAP),
                     &out->view);
  return PL_OK;
}

pl_status pl_frame_plan(pl_renderer *renderer, const pl_frame_request *request, bool metered,
                        bool developed, pl_survey *survey, pl_sensor *sensor,
                        pl_frame_result *result) {
  pl_view *view = &survey->view;
  double start = now_s();
  *result = (pl_frame_result){0};
  PL_TRY(survey_frame(renderer, request, survey));
  lap(result, PL_STAGE_SNAPSHOT, &start);
  developed = developed && request->sensor != NULL;
  if (developed)
    *sensor = *request->sensor;
  PL_TRY(expose(renderer, request, metered, survey, developed ? sensor : NULL));
  result->exposure_s = developed ? sensor->exposure_s : NAN;
  result->gain = developed ? sensor->gain : NAN;
  result->white_radiance = request->exposure.automatic && !metered ? NAN : view->white_radiance;
  find_whites(request, view, result->whites);
  PL_TRY(pl_frame_sky_view(request->sky, &survey->shot, &request->wish, &renderer->arena, view,
                           &survey->sky));
  lap(result, PL_STAGE_METER, &start);
  PL_TRY(pl_survey_plan(survey, &request->wish, metered, &renderer->arena, &result->plan));
  if (pl_moving(request, &result->plan))
    PL_TRY(pl_moving_plan(renderer, request, view, metered, &result->plan));
  lap(result, PL_STAGE_PLAN, &start);
  return PL_OK;
}

pl_status pl_renderer_plan(pl_renderer *renderer, const pl_frame_request *request,
                           pl_frame_result *result) {
  pl_survey survey;
  pl_sensor sensor;
  return pl_frame_plan(renderer, request, true, true, &survey, &sensor, result);
}

static pl_status allocate_bands(pl_renderer *renderer, const pl_camera *camera, pl_vec3f **out) {
  const size_t pixels = (size_t)camera->width * (size_t)camera->height;
  *out = pl_arena_alloc(&renderer->arena, pixels, sizeof **out);
  return *out != NULL ? PL_OK : pl_fail(PL_E_MEMORY, "out of memory for a sensor's image");
}

pl_status pl_frame_light_sky(pl_renderer *renderer, const pl_frame_request *request,
                             const pl_plan *plan, const pl_instant *instant, bool subpixel,
                             pl_arena *arena, pl_frame_sky *sky) {
  if (instant->settings.samples == 0)
    return PL_OK;
  if (subpixel)
    PL_TRY(pl_subpixel_render(instant, renderer->scratch, arena, request->cancel, sky));
  return pl_frame_sky_place(plan, &instant->shot, instant->tracer, &instant->settings, arena, sky);
}

pl_status pl_frame_render(pl_renderer *renderer, const pl_frame_request *request,
                          const pl_instant *instant, const pl_frame_sky *sky, pl_tile_fn done,
                          void *context) {
  pl_render_settings settings = instant->settings;
  atomic_size_t missed = 0;
  settings.missed = &missed;
  settings.backdrop = sky->backdrop.kind != PL_BACKDROP_NONE ? &sky->backdrop : NULL;
  PL_TRY(pl_render(&instant->shot, instant->tracer, &settings, renderer->scratch, done, context,
                   request->cancel));
  renderer->missed += atomic_load(&missed);
  return PL_OK;
}

/* Renders a still frame, or the instants of a moving one. */
static pl_status render_frame(pl_renderer *renderer, const pl_frame_request *request,
                              const pl_survey *survey, const pl_choice *choice,
                              const pl_instant *instant, pl_frame_result *result,
                              pl_output *output) {
  const bool moves = pl_moving(request, &result->plan);
  pl_frame_sky sky = survey->sky;
  PL_TRY(pl_frame_light_sky(renderer, request, &result->plan, instant, !moves, &renderer->arena,
                            &sky));
  result->stars = sky.seen;
  result->star_count = sky.seen_count;
  output->sky = &sky;
  if (!moves)
    PL_TRY(pl_frame_render(renderer, request, instant, &sky, pl_output_tile, output));
  else
    PL_TRY(
        pl_moving_render(renderer, request, &result->plan, &survey->view, choice, instant, output));
  output->sky = NULL;
  return PL_OK;
}

/* Counts what outputs take beside rays and light. */
static void count_outputs(const pl_frame_request *request, const pl_plan *plan) {
  const pl_camera *camera = &request->placement.camera;
  const size_t pixels = (size_t)camera->width * (size_t)camera->height;
  size_t channels = 0;
  for (int i = 0; i < PL_FRAME_CHANNELS_MAX; i++)
    channels += request->channels[i] != NULL;
  pl_work_add(PL_WORK_frames, 1);
  pl_work_add(PL_WORK_label_values, pixels * channels);
  pl_work_add(PL_WORK_object_pixels, request->objects != NULL ? pixels : 0);
  if (request->pilot && request->sensor != NULL)
    pl_work_add(PL_WORK_sensor_values, pixels * pl_sensor_stages_of(request->sensor, plan));
}

pl_status pl_renderer_frame(pl_renderer *renderer, const pl_frame_request *request,
                            pl_frame_result *result) {
  pl_survey survey;
  pl_sensor sensor;
  const pl_instant *instant;
  const bool colour = wants_colour(request);
  const bool develop = pl_frame_wants_sensor(request) && !request->pilot;
  const bool exposed = develop || (request->pilot && request->sensor != NULL);
  const pl_work_counts before = pl_work_done;
  renderer->missed = 0;
  PL_TRY(pl_frame_plan(renderer, request, colour, exposed, &survey, &sensor, result));
  double start = now_s();
  const pl_choice choice = pl_choice_of_plan(request, result, colour);
  PL_TRY(pl_realise(renderer->accelerators, &survey, &choice, &renderer->arena, &instant));
  pl_height_fields_report(renderer->accelerators, &instant->shot, result);
  pl_output output = {
      .request = request,
      .shot = &instant->shot,
      .encoder = &renderer->encoder,
      .white_radiance = (float)result->white_radiance,
      .colour = true,
  };
  if (develop)
    PL_TRY(allocate_bands(renderer, &instant->shot.rays.camera, &output.bands));
  PL_TRY(pl_labels_prepare(request, &instant->shot, &renderer->label_tools, &renderer->arena,
                           &output.labels));
  PL_TRY(pl_frame_flow(renderer, request, &result->plan, &choice, &output.labels.flow));
  lap(result, PL_STAGE_REALISE, &start);
  PL_TRY(render_frame(renderer, request, &survey, &choice, instant, result, &output));
  lap(result, PL_STAGE_RENDER, &start);
  PL_TRY(pl_frame_keypoints(renderer->scene, request, &result->plan, instant));
  PL_TRY(pl_labels_finish(&output.labels, renderer->accelerators, &renderer->label_tools,
                          &renderer->arena));
  lap(result, PL_STAGE_LABEL, &start);
  if (develop)
    PL_TRY(pl_frame_develop(renderer, request, instant, &sensor, &result->plan, output.bands));
  lap(result, PL_STAGE_SENSOR, &start);
  result->missed = renderer->missed;
  result->aimed = choice.settings.target_dn > 0.0f && choice.colour &&
                  pl_plan_value(&result->plan, &pl_effect_motion_blur) == 0 &&
                  !(instant->shot.rays.camera.aperture_m > 0.0);
  count_outputs(request, &result->plan);
  result->work = pl_work_since(&before);
  return PL_OK;
}
