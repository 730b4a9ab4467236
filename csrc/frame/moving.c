/* Renders the instants of a frame one after the other. */
#include "frame/moving.h"

#include "frame/effects.h"
#include "plan/effects.h"
#include "scene/shutter.h"
#include "trace/height_field.h"

/* Number of instants at which the plan's view is evaluated. */
enum { PLAN_INSTANTS = 9 };
/* Limit on the instants of a frame with blur and a rolling shutter: this many, plus four per row.
 */
enum { INSTANTS_MAX = 256, INSTANTS_ROW = 4 };

static bool blurs(const pl_frame_request *request, const pl_plan *plan) {
  return pl_plan_value(plan, &pl_effect_motion_blur) > 1 &&
         request->placement.shutter.exposure_s > 0.0;
}

static int bands_of(const pl_frame_request *request, const pl_plan *plan) {
  const int bands = pl_plan_value(plan, &pl_effect_rolling_shutter);
  return bands > 1 && request->placement.shutter.line_s > 0.0 ? bands : 1;
}

bool pl_moving(const pl_frame_request *request, const pl_plan *plan) {
  return blurs(request, plan) || bands_of(request, plan) > 1;
}

bool pl_moving_rolls(const pl_frame_request *request, const pl_plan *plan) {
  return bands_of(request, plan) > 1;
}

pl_status pl_moving_plan(pl_renderer *renderer, const pl_frame_request *request,
                         const pl_view *middle, bool colour, pl_plan *plan) {
  pl_survey survey;
  pl_plan now;
  for (int i = 0; i < PLAN_INSTANTS; i++) {
    pl_arena_reset(&renderer->instants);
    PL_TRY(pl_survey_at(renderer->scene, request, (double)i / (PLAN_INSTANTS - 1), middle,
                        &renderer->instants, &survey));
    PL_TRY(pl_survey_plan(&survey, &request->wish, colour, &renderer->instants, &now));
    for (size_t k = 0; k < plan->count; k++) {
      pl_plan_row *row = &plan->rows[k];
      const double residual = fmax(row->residual_dn, now.rows[k].residual_dn);
      /* At each instant, what the larger value takes is within what that instant's own took. */
      const double spent = fmax(row->spent_dn, now.rows[k].spent_dn);
      if (now.rows[k].value > row->value ||
          (now.rows[k].value == row->value && now.rows[k].bound_dn > row->bound_dn))
        *row = now.rows[k];
      row->residual_dn = residual;
      row->spent_dn = spent;
    }
  }
  return PL_OK;
}

pl_status pl_moving_realise(pl_renderer *renderer, const pl_frame_request *request,
                            const pl_plan *plan, const pl_view *middle, double u,
                            const pl_choice *choice, pl_frame_sky *sky, const pl_instant **out) {
  pl_arena *arena = &renderer->instants;
  pl_survey survey;
  pl_arena_reset(arena);
  PL_TRY(pl_survey_at(renderer->scene, request, u, middle, arena, &survey));
  if (choice->colour) {
    PL_TRY(pl_survey_fit(&survey, plan, arena));
    PL_TRY(pl_frame_sky_view(request->sky, &survey.shot, &request->wish, arena, &survey.view,
                             &survey.sky));
  }
  PL_TRY(pl_realise(renderer->accelerators, &survey, choice, arena, out));
  *sky = survey.sky;
  return pl_frame_light_sky(renderer, request, plan, *out, true, arena, sky);
}

/* Adds the stars of an instant, weighted for each row by the part of its exposure that falls into
 * the instant. */
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

/* Shared by all instants of a frame. */
typedef struct exposure {
  pl_renderer *renderer;
  const pl_frame_request *request;
  const pl_plan *plan;
  const pl_view *middle;
  pl_output *output;
} exposure;

/* Renders one instant. Its ground is not used afterwards. */
static pl_status render_at(const exposure *e, double time_s, const pl_choice *choice,
                           pl_tile_fn done) {
  pl_renderer *renderer = e->renderer;
  const pl_frame_request *request = e->request;
  const double u = time_s / pl_shutter_window_s(&request->placement);
  const size_t grounds = pl_ground_scenes(renderer->accelerators);
  pl_frame_sky sky;
  const pl_instant *instant;
  PL_TRY(pl_moving_realise(renderer, request, e->plan, e->middle, u, choice, &sky, &instant));
  e->output->shot = &instant->shot;
  e->output->sky = &sky;
  PL_TRY(pl_frame_render(renderer, request, instant, &sky, done, e->output));
  if (choice->colour && choice->settings.slice != NULL)
    add_stars(choice->settings.slice, &sky, &instant->shot.rays.camera, e->output->film);
  pl_ground_scenes_release(renderer->accelerators, grounds);
  return PL_OK;
}

/* Renders bands of rows, each at the middle of its exposure. */
static pl_status render_bands(const exposure *e, pl_choice choice) {
  const pl_shutter *shutter = &e->request->placement.shutter;
  const int height = e->request->placement.camera.height, bands = bands_of(e->request, e->plan);
  for (int band = 0; band < bands; band++) {
    choice.settings.row0 = (int)((int64_t)band * height / bands);
    choice.settings.row1 = (int)((int64_t)(band + 1) * height / bands);
    const double row = 0.5 * (choice.settings.row0 + choice.settings.row1 - 1);
    PL_TRY(render_at(e, pl_shutter_row_s(shutter, row), &choice, pl_output_tile));
  }
  return PL_OK;
}

/* Returns the mapping of samples to instants. */
static pl_slice slices_of(const pl_frame_request *request, const pl_plan *plan) {
  const pl_shutter *shutter = &request->placement.shutter;
  const int height = request->placement.camera.height;
  const int blur = pl_plan_value(plan, &pl_effect_motion_blur);
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

/* Sets the range of rows that are exposed at some time of an instant. */
static void rows_of(const pl_slice *slice, int height, pl_render_settings *settings) {
  const double length_s = slice->span_s / slice->count;
  const double from_s = slice->start_s + slice->instant * length_s - slice->offset_s;
  settings->row0 = 0;
  settings->row1 = height;
  if (!(slice->row_s > 0.0))
    return;
  /* Rows that close before the instant or open after it have no samples. One more row on each side
   * allows for rounding. */
  const double first = floor((from_s - slice->spread_s) / slice->row_s) - 1.0;
  const double last = ceil((from_s + length_s) / slice->row_s) + 1.0;
  settings->row0 = (int)fmin(fmax(first, 0.0), height - 1);
  settings->row1 = (int)fmin(fmax(last + 1.0, settings->row0 + 1), height);
}

static pl_status add_tile(void *context, const pl_tile_result *result, int worker) {
  const pl_output *output = context;
  const size_t width = (size_t)output->shot->rays.camera.width;
  (void)worker;
  for (int y = 0; y < result->tile.height; y++) {
    pl_vec3f *row = output->film + (size_t)(result->tile.y0 + y) * width + result->tile.x0;
    for (int x = 0; x < result->tile.width; x++)
      row[x] = pl_vec3f_add(row[x], result->radiance[y * PL_TILE_SIDE + x]);
  }
  return PL_OK;
}

static pl_status render_blur(const exposure *e, pl_choice choice) {
  const pl_camera *camera = &e->request->placement.camera;
  const size_t width = (size_t)camera->width, pixels = width * (size_t)camera->height;
  pl_output *output = e->output;
  pl_slice slice = slices_of(e->request, e->plan);
  output->film = pl_arena_alloc(&e->renderer->arena, pixels, sizeof *output->film);
  if (output->film == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for an exposure");
  for (size_t i = 0; i < pixels; i++)
    output->film[i] = (pl_vec3f){0.0f, 0.0f, 0.0f};
  choice.settings.slice = &slice;
  for (slice.instant = 0; slice.instant < slice.count; slice.instant++) {
    const double time_s = slice.start_s + slice.span_s * (slice.instant + 0.5) / slice.count;
    rows_of(&slice, camera->height, &choice.settings);
    PL_TRY(render_at(e, time_s, &choice, add_tile));
  }
  for (size_t first = 0; first < pixels; first += width)
    pl_output_colour(output, first, output->film + first, width);
  return PL_OK;
}

/* Renders labels at the middle of each row's exposure. */
static pl_status render_labels(const exposure *e, const pl_choice *choice,
                               const pl_instant *middle) {
  if (bands_of(e->request, e->plan) > 1)
    return render_bands(e, pl_choice_of_labels(choice));
  pl_render_settings settings = middle->settings;
  settings.samples = 0;
  settings.air = NULL;
  settings.media = NULL;
  return pl_render(&middle->shot, middle->tracer, &settings, e->renderer->scratch, pl_output_tile,
                   e->output, e->request->cancel);
}

pl_status pl_moving_render(pl_renderer *renderer, const pl_frame_request *request,
                           const pl_plan *plan, const pl_view *view, const pl_choice *choice,
                           const pl_instant *instant, pl_output *output) {
  const exposure e = {renderer, request, plan, view, output};
  if (!blurs(request, plan)) {
    PL_TRY(render_bands(&e, *choice));
  } else {
    output->colour = false;
    PL_TRY(render_labels(&e, choice, instant));
    if (choice->colour)
      PL_TRY(render_blur(&e, *choice));
  }
  output->shot = &instant->shot;
  output->sky = NULL; /* the last one belonged to an instant */
  return PL_OK;
}
