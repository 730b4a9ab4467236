/* Instants, one after the other. */
#include "frame/moving.h"

#include "frame/dots.h"
#include "frame/effects.h"
#include "render/laws.h"
#include "scene/shutter.h"

/* Instants whose views the plan looks at. */
enum { LOOKS = 9 };
/* Instants of a frame with blur and a rolling shutter: no more than this, and four a row. */
enum { INSTANTS_MAX = 256, INSTANTS_ROW = 4 };

static bool blurs(const pl_frame_request *request, const pl_plan *plan) {
  return pl_plan_value(plan, "motion_blur") > 1 && request->placement.shutter.exposure_s > 0.0;
}

static int bands_of(const pl_frame_request *request, const pl_plan *plan) {
  const int bands = pl_plan_value(plan, "rolling_shutter");
  return bands > 1 && request->placement.shutter.line_s > 0.0 ? bands : 1;
}

bool pl_moving(const pl_frame_request *request, const pl_plan *plan) {
  return blurs(request, plan) || bands_of(request, plan) > 1;
}

/* The world at an instant. */
typedef struct instant {
  pl_placement placement; /* borrowed by shot */
  pl_snapshot shot;
  pl_view view;
} instant;

/* `u`: part of the frame's time. `middle`: tells the view what the user and the sensor want. */
static pl_status stop(pl_renderer *renderer, const pl_frame_request *request, double u,
                      const pl_view *middle, bool laws, instant *out) {
  pl_arena *arena = &renderer->instants;
  pl_arena_reset(arena);
  PL_TRY(pl_placement_at(renderer->scene, &request->placement, u, arena, &out->placement));
  PL_TRY(pl_snapshot_build(renderer->scene, &out->placement, arena, &out->shot));
  PL_TRY(pl_snapshot_view(&out->shot, arena, &out->view));
  pl_frame_view_wants(request, &out->view);
  out->view.white_radiance = middle->white_radiance;
  out->view.display_white = middle->display_white;
  out->view.sensor = middle->sensor;
  out->view.blur_px = middle->blur_px;
  out->view.skew_px = middle->skew_px;
  out->view.sky = middle->sky;
  return laws ? pl_laws_build(&out->shot, arena, &out->view) : PL_OK;
}

pl_status pl_moving_plan(pl_renderer *renderer, const pl_frame_request *request,
                         const pl_view *middle, bool colour, pl_plan *plan) {
  instant instant;
  pl_plan now;
  for (int i = 0; i < LOOKS; i++) {
    PL_TRY(stop(renderer, request, (double)i / (LOOKS - 1), middle, colour, &instant));
    PL_TRY(pl_plan_solve(pl_effects, pl_effect_count, &instant.view, &request->wish, &now));
    for (size_t k = 0; k < plan->count; k++) {
      pl_plan_row *row = &plan->rows[k];
      const double residual = fmax(row->residual_dn, now.rows[k].residual_dn);
      if (now.rows[k].value > row->value ||
          (now.rows[k].value == row->value && now.rows[k].bound_dn > row->bound_dn))
        *row = now.rows[k];
      row->residual_dn = residual;
    }
  }
  return PL_OK;
}

/* Adds the stars of an instant: its part of the light of the rows that are exposed then. */
static void add_stars(const pl_slice *slice, const pl_frame_sky *sky, const pl_camera *camera,
                      pl_vec3f *film) {
  const size_t tiles =
      (size_t)sky->columns * (size_t)((camera->height + PL_TILE_SIDE - 1) / PL_TILE_SIDE);
  const double length_s = slice->span_s / slice->count;
  const double from_s = slice->start_s + length_s * slice->instant - slice->offset_s;
  for (size_t i = 0; sky->first != NULL && i < sky->first[tiles]; i++) {
    const pl_star_light *light = &sky->light[i];
    const int row = (int)(light->pixel / (uint32_t)camera->width);
    const double open_s = from_s - row * slice->row_s; /* since the row's exposure began */
    const double part_s = fmin(open_s + length_s, slice->spread_s) - fmax(open_s, 0.0);
    if (part_s > 0.0)
      film[light->pixel] =
          pl_vec3f_madd(film[light->pixel], (float)(part_s / slice->spread_s), light->light);
  }
}

/* Turns the tracer to an instant and renders it. */
static pl_status render_at(pl_renderer *renderer, const pl_frame_request *request,
                           const pl_plan *plan, double time_s, int emitters,
                           pl_render_settings settings, pl_tile_fn done, pl_output *output) {
  instant instant;
  pl_emitters lights;
  pl_planetshine shine;
  pl_caustics caustics;
  pl_air_view air;
  pl_veils veils;
  pl_frame_sky sky = {0};
  pl_arena *arena = &renderer->instants;
  const bool colour = settings.samples > 0;
  const pl_view middle = {.white_radiance = (double)settings.white_radiance,
                          .display_white = (double)output->white_radiance,
                          .sensor = output->sensor};
  const double u = time_s / pl_shutter_window_s(&request->placement);
  settings.air = NULL;
  settings.veils = NULL;
  settings.backdrop = NULL;
  PL_TRY(stop(renderer, request, u, &middle, colour, &instant));
  if (colour)
    PL_TRY(
        pl_frame_sky_view(request->sky, &instant.shot, &request->wish, arena, &instant.view, &sky));
  pl_snapshot_cull(&instant.shot, &instant.view, request->wish.tolerance_dn);
  pl_frame_apply(plan, &instant.shot);
  if (colour)
    pl_dots_mark(&instant.shot, &instant.view, request->wish.tolerance_dn);
  PL_TRY(pl_tracer_set(renderer->tracer, &instant.shot));
  if (colour) {
    PL_TRY(pl_frame_emitters(arena, &instant.shot, emitters, &lights, &settings));
    PL_TRY(pl_frame_air(arena, &instant.shot, plan, &air, &settings));
    PL_TRY(pl_frame_veils(arena, &instant.shot, plan, &veils, &settings));
    PL_TRY(pl_frame_planetshine(arena, &instant.shot, plan, &shine, &settings));
    pl_frame_caustics(renderer, &instant.shot, plan, &caustics, &settings);
    PL_TRY(pl_dots_render(renderer, &instant.shot, &settings, arena, request->cancel, &sky));
    PL_TRY(pl_frame_sky_place(plan, &instant.shot, renderer->tracer, &settings, arena, &sky));
    settings.backdrop = sky.backdrop.kind != PL_BACKDROP_NONE ? &sky.backdrop : NULL;
  }
  output->shot = &instant.shot;
  output->sky = &sky;
  PL_TRY(pl_render(&instant.shot, renderer->tracer, &settings, renderer->scratch, done, output,
                   request->cancel));
  if (colour && settings.slice != NULL)
    add_stars(settings.slice, &sky, &instant.shot.camera, output->film);
  return PL_OK;
}

/* Rows in bands, each in the middle of its exposure. */
static pl_status render_bands(pl_renderer *renderer, const pl_frame_request *request,
                              const pl_plan *plan, pl_render_settings settings, int emitters,
                              pl_output *output) {
  const pl_shutter *shutter = &request->placement.shutter;
  const int height = request->placement.camera.height, bands = bands_of(request, plan);
  for (int band = 0; band < bands; band++) {
    settings.row0 = (int)((int64_t)band * height / bands);
    settings.row1 = (int)((int64_t)(band + 1) * height / bands);
    const double row = 0.5 * (settings.row0 + settings.row1 - 1);
    const double time_s = row * shutter->line_s + 0.5 * shutter->exposure_s;
    PL_TRY(render_at(renderer, request, plan, time_s, emitters, settings, pl_output_tile, output));
  }
  return PL_OK;
}

/* Which samples are of which instants. */
static pl_slice slices_of(const pl_frame_request *request, const pl_plan *plan) {
  const pl_shutter *shutter = &request->placement.shutter;
  const int height = request->placement.camera.height;
  const int blur = pl_plan_value(plan, "motion_blur");
  const double e = shutter->exposure_s, line = shutter->line_s;
  const double middle_s = 0.5 * (height - 1) * line;
  if (bands_of(request, plan) == 1)
    return (pl_slice){
        .count = blur, .start_s = middle_s, .span_s = e, .offset_s = middle_s, .spread_s = e};
  const double span_s = e + height * line;
  const double most = INSTANTS_MAX + INSTANTS_ROW * (double)height;
  return (pl_slice){.count = (int)fmin(ceil(blur * span_s / e), most),
                    .start_s = -0.5 * line,
                    .span_s = span_s,
                    .row_s = line,
                    .spread_s = e};
}

/* The rows that gather light at some time of an instant. */
static void rows_of(const pl_slice *slice, int height, pl_render_settings *settings) {
  const double length_s = slice->span_s / slice->count;
  const double from_s = slice->start_s + slice->instant * length_s - slice->offset_s;
  settings->row0 = 0;
  settings->row1 = height;
  if (!(slice->row_s > 0.0))
    return;
  /* Rows that close before the instant's time, or open after it, have none; one more for rounding.
   */
  const double first = floor((from_s - slice->spread_s) / slice->row_s) - 1.0;
  const double last = ceil((from_s + length_s) / slice->row_s) + 1.0;
  settings->row0 = (int)fmin(fmax(first, 0.0), height - 1);
  settings->row1 = (int)fmin(fmax(last + 1.0, settings->row0 + 1), height);
}

static pl_status add_tile(void *context, const pl_tile_result *result, int worker) {
  const pl_output *output = context;
  const size_t width = (size_t)output->shot->camera.width;
  (void)worker;
  for (int y = 0; y < result->tile.height; y++) {
    pl_vec3f *row = output->film + (size_t)(result->tile.y0 + y) * width + result->tile.x0;
    for (int x = 0; x < result->tile.width; x++)
      row[x] = pl_vec3f_add(row[x], result->radiance[y * PL_TILE_SIDE + x]);
  }
  return PL_OK;
}

static pl_status render_blur(pl_renderer *renderer, const pl_frame_request *request,
                             const pl_plan *plan, pl_render_settings settings, int emitters,
                             pl_output *output) {
  const pl_camera *camera = &request->placement.camera;
  const size_t width = (size_t)camera->width, pixels = width * (size_t)camera->height;
  pl_slice slice = slices_of(request, plan);
  output->film = pl_arena_alloc(&renderer->arena, pixels, sizeof *output->film);
  if (output->film == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for an exposure");
  for (size_t i = 0; i < pixels; i++)
    output->film[i] = (pl_vec3f){0.0f, 0.0f, 0.0f};
  settings.slice = &slice;
  for (slice.instant = 0; slice.instant < slice.count; slice.instant++) {
    const double time_s = slice.start_s + slice.span_s * (slice.instant + 0.5) / slice.count;
    rows_of(&slice, camera->height, &settings);
    PL_TRY(render_at(renderer, request, plan, time_s, emitters, settings, add_tile, output));
  }
  for (size_t first = 0; first < pixels; first += width)
    pl_output_colour(output, first, output->film + first, width);
  return PL_OK;
}

pl_status pl_moving_render(pl_renderer *renderer, const pl_frame_request *request,
                           const pl_plan *plan, const pl_render_settings *settings, int emitters,
                           pl_output *output) {
  const pl_snapshot *middle = output->shot;
  pl_render_settings labels = *settings;
  pl_status status = PL_OK;
  if (!blurs(request, plan)) {
    status = render_bands(renderer, request, plan, *settings, emitters, output);
  } else {
    labels.samples = 0;
    labels.backdrop = NULL;
    labels.air = NULL;
    labels.veils = NULL;
    output->colour = false;
    if (bands_of(request, plan) > 1)
      status = render_bands(renderer, request, plan, labels, 0, output);
    else
      status = pl_render(middle, renderer->tracer, &labels, renderer->scratch, pl_output_tile,
                         output, request->cancel);
    if (status == PL_OK && settings->samples > 0)
      status = render_blur(renderer, request, plan, *settings, emitters, output);
  }
  output->shot = middle;
  output->sky = NULL; /* an instant's */
  return status == PL_OK ? pl_tracer_set(renderer->tracer, middle) : status;
}
