/* Events from pictures of single instants. All have the same random numbers, so that what noise
 * they have does not flicker. */
#include "frame/events.h"

#include "base/memory.h"
#include "frame/moving.h"
#include "frame/renderer.h"
#include "math/color.h"
#include "scene/shutter.h"
#include "trace/height_field.h"

typedef struct recording {
  pl_renderer *renderer;
  const pl_frame_request *request;
  const pl_event_settings *settings;
  const pl_plan *plan;
  const pl_view *middle;
  pl_choice choice;
  int width, height, pictures;
  double duration_s;
  pl_event_pixel *pixels;
  pl_event_list *rows; /* events of each row */
  /* pictures by depth of halving: logarithms of light */
  float *levels[PL_EVENT_HALVINGS_MAX + 3];
} recording;

/* --- pictures --------------------------------------------------------------------------------- */

typedef struct film {
  const recording *of;
  const pl_frame_sky *sky;
  float *out;
} film;

static pl_status take_tile(void *context, const pl_tile_result *result, int worker) {
  const film *film = context;
  pl_vec3f lit[PL_TILE_PIXELS];
  const pl_vec3f *radiance = pl_frame_sky_tile(film->sky, result, lit);
  const float dark = (float)film->of->settings->camera.dark;
  (void)worker;
  for (int y = 0; y < result->tile.height; y++) {
    float *row = film->out + (size_t)(result->tile.y0 + y) * (size_t)film->of->width;
    for (int x = 0; x < result->tile.width; x++)
      row[result->tile.x0 + x] = logf(pl_luminance(radiance[y * PL_TILE_SIDE + x]) + dark);
  }
  return PL_OK;
}

/* Makes the picture at a fraction of the time. */
static pl_status picture(recording *r, double u, float *out) {
  pl_renderer *renderer = r->renderer;
  const pl_frame_request *request = r->request;
  const size_t grounds = pl_ground_scenes(renderer->accelerators);
  pl_frame_sky sky;
  const pl_instant *instant;
  r->pictures++;
  PL_TRY(pl_moving_realise(renderer, request, r->plan, r->middle, u, &r->choice, &sky, &instant));
  film film = {r, &sky, out};
  PL_TRY(pl_frame_render(renderer, request, instant, &sky, take_tile, &film));
  pl_ground_scenes_release(renderer->accelerators, grounds);
  return PL_OK;
}

/* --- steps ------------------------------------------------------------------------------------ */

typedef struct step {
  recording *r;
  double t0, t1;
  const float *from, *to;
} step;

static pl_status go_row(void *context, size_t row, int worker) {
  const step *s = context;
  recording *r = s->r;
  const size_t first = row * (size_t)r->width;
  (void)worker;
  for (int x = 0; x < r->width; x++) {
    const size_t i = first + (size_t)x;
    PL_TRY(pl_event_pixel_go(&r->settings->camera, &r->pixels[i], (uint16_t)x, (uint16_t)row, s->t0,
                             s->t1, (double)s->from[i], (double)s->to[i], &r->rows[row]));
  }
  return PL_OK;
}

static pl_status go(recording *r, double u0, double u1, const float *from, const float *to) {
  step step = {r, u0 * r->duration_s, u1 * r->duration_s, from, to};
  return pl_parallel_for(r->request->threads, (size_t)r->height, go_row, &step, r->request->cancel);
}

/* Whether a step's middle is where a straight line has it, in all but a few pixels. */
static bool is_straight(const recording *r, const float *from, const float *middle,
                        const float *to) {
  const size_t count = (size_t)r->width * (size_t)r->height;
  size_t off = 0;
  for (size_t i = 0; i < count; i++)
    off +=
        fabs((double)middle[i] - 0.5 * ((double)from[i] + (double)to[i])) > r->settings->tolerance;
  return (double)off <= r->settings->tolerated_pixels * (double)count;
}

static pl_status span(recording *r, double u0, double u1, const float *from, const float *to,
                      int depth) {
  if (depth == r->settings->halvings)
    return go(r, u0, u1, from, to);
  const double middle = 0.5 * (u0 + u1);
  float *between = r->levels[2 + depth];
  PL_TRY(picture(r, middle, between));
  if (is_straight(r, from, between, to)) {
    PL_TRY(go(r, u0, middle, from, between));
    return go(r, middle, u1, between, to);
  }
  PL_TRY(span(r, u0, middle, from, between, depth + 1));
  return span(r, middle, u1, between, to, depth + 1);
}

static pl_status record(recording *r) {
  const pl_event_camera *camera = &r->settings->camera;
  const size_t count = (size_t)r->width * (size_t)r->height;
  const int steps = r->settings->instants;
  PL_TRY(picture(r, 0.0, r->levels[0]));
  for (size_t i = 0; i < count; i++)
    pl_event_pixel_start(camera, i, (double)r->levels[0][i], &r->pixels[i]);
  for (int k = 0; k < steps; k++) {
    PL_TRY(picture(r, (double)(k + 1) / steps, r->levels[1]));
    PL_TRY(span(r, (double)k / steps, (double)(k + 1) / steps, r->levels[0], r->levels[1], 0));
    float *last = r->levels[0];
    r->levels[0] = r->levels[1];
    r->levels[1] = last;
  }
  for (size_t i = 0; i < count; i++)
    PL_TRY(pl_event_noise(camera, i, (uint16_t)(i % (size_t)r->width),
                          (uint16_t)(i / (size_t)r->width), r->duration_s,
                          &r->rows[i / (size_t)r->width]));
  return PL_OK;
}

/* Moves the events of all rows to one sorted list. */
static pl_status collect(recording *r, pl_event_list *out) {
  size_t count = 0;
  for (int y = 0; y < r->height; y++)
    count += r->rows[y].count;
  void *items;
  PL_TRY(pl_alloc_or_fail(count, sizeof(pl_event), "events", &items));
  *out = (pl_event_list){.items = items, .room = count};
  for (int y = 0; y < r->height; y++)
    for (size_t i = 0; i < r->rows[y].count; i++)
      out->items[out->count++] = r->rows[y].items[i];
  pl_events_sort(out->items, out->count);
  return PL_OK;
}

static pl_status allocate(recording *r) {
  pl_arena *arena = &r->renderer->sensor_arena;
  const size_t count = (size_t)r->width * (size_t)r->height;
  pl_arena_reset(arena);
  r->pixels = pl_arena_alloc(arena, count, sizeof *r->pixels);
  r->rows = pl_arena_alloc(arena, (size_t)r->height, sizeof *r->rows);
  bool made = r->pixels != NULL && r->rows != NULL;
  for (int i = 0; i < r->settings->halvings + 2; i++)
    made = (r->levels[i] = pl_arena_alloc(arena, count, sizeof(float))) != NULL && made;
  if (!made)
    return pl_fail(PL_E_MEMORY, "out of memory for the pictures of events");
  for (int y = 0; y < r->height; y++)
    r->rows[y] = (pl_event_list){.items = NULL};
  return PL_OK;
}

static pl_status check(const pl_frame_request *request, const pl_event_settings *settings) {
  PL_TRY(pl_event_camera_check(&settings->camera));
  if (settings->instants < 1 || settings->instants > PL_EVENT_INSTANTS_MAX)
    return pl_fail(PL_E_RANGE, "events: instants must be in 1..%d, not %d", PL_EVENT_INSTANTS_MAX,
                   settings->instants);
  if (settings->halvings < 0 || settings->halvings > PL_EVENT_HALVINGS_MAX)
    return pl_fail(PL_E_RANGE, "events: halvings must be in 0..%d, not %d", PL_EVENT_HALVINGS_MAX,
                   settings->halvings);
  if (!(settings->tolerance > 0.0) || !(settings->tolerated_pixels >= 0.0))
    return pl_fail(PL_E_RANGE,
                   "events: the tolerance must be above 0, tolerated_pixels at least 0");
  if (!(request->placement.shutter.exposure_s > 0.0) || request->placement.shutter.line_s > 0.0)
    return pl_fail(PL_E_ARGUMENT, "events need a time, and no rolling shutter");
  return PL_OK;
}

pl_status pl_renderer_events(pl_renderer *renderer, const pl_frame_request *request,
                             const pl_event_settings *settings, pl_event_list *out, int *pictures) {
  pl_survey survey;
  pl_sensor sensor;
  pl_frame_result result;
  PL_TRY(check(request, settings));
  PL_TRY(pl_frame_plan(renderer, request, true, false, &survey, &sensor, &result));
  recording r = {
      .renderer = renderer,
      .request = request,
      .settings = settings,
      .plan = &result.plan,
      .middle = &survey.view,
      .choice = pl_choice_of_plan(request, &result, true),
      .width = request->placement.camera.width,
      .height = request->placement.camera.height,
      .duration_s = request->placement.shutter.exposure_s,
  };
  /* Every pixel gets all samples: what is adaptive would flicker. */
  r.choice.settings.noise_dn = 0.0f;
  r.choice.settings.exact = true;
  PL_TRY(allocate(&r));
  pl_status status = record(&r);
  if (status == PL_OK)
    status = collect(&r, out);
  for (int y = 0; y < r.height; y++)
    pl_event_list_clear(&r.rows[y]);
  *pictures = r.pictures;
  return status;
}
