/* The table of sensor stages, and functions that they share. */
#include "sensor/stage.h"

#include <math.h>

#include "base/work.h"
#include "sensor/draws.h"
#include "sensor/glare.h"
#include "plan/effects.h"
#include "sensor/stages.h"

#define PL_EFFECT(name) {#name, &pl_effect_##name, pl_stage_##name},
#define PL_STEP(name) {#name, NULL, pl_stage_##name},
const pl_sensor_stage pl_sensor_stages[] = {PL_SENSOR_STAGES(PL_EFFECT, PL_STEP)};
const size_t pl_sensor_stage_count = sizeof pl_sensor_stages / sizeof pl_sensor_stages[0];

static int value_of(const pl_sensor_stage *stage, const pl_plan *plan) {
  return stage->effect == NULL ? 1 : pl_plan_value(plan, stage->effect);
}

size_t pl_sensor_stages_of(const pl_sensor *sensor, const pl_plan *plan) {
  size_t on = 0;
  for (size_t i = 0; i < pl_sensor_stage_count; i++)
    on += value_of(&pl_sensor_stages[i], plan) > 0;
  return on * (sensor->plane_count > 0 ? (size_t)sensor->plane_count : 1);
}

pl_status pl_sensor_run(pl_sensor_frame *frame, const pl_plan *plan) {
  for (size_t i = 0; i < pl_sensor_stage_count; i++) {
    const pl_sensor_stage *stage = &pl_sensor_stages[i];
    const int value = value_of(stage, plan);
    if (value > 0)
      PL_TRY(stage->run(frame, value));
    pl_work_add(PL_WORK_sensor_values,
                value > 0 ? (size_t)frame->width * (size_t)frame->height : 0);
    if (frame->glare != NULL)
      pl_glare_follow(frame, stage);
  }
  return PL_OK;
}

typedef struct lines {
  pl_sensor_frame *frame;
  pl_line_fn work;
} lines;

static pl_status run_line(void *context, size_t item, int worker) {
  (void)worker;
  const lines *job = context;
  job->work(job->frame, (int)item);
  return PL_OK;
}

pl_status pl_sensor_rows(pl_sensor_frame *frame, pl_line_fn work) {
  lines job = {frame, work};
  return pl_parallel_for(frame->threads, (size_t)frame->height, run_line, &job, frame->cancel);
}

pl_status pl_sensor_columns(pl_sensor_frame *frame, pl_line_fn work) {
  lines job = {frame, work};
  return pl_parallel_for(frame->threads, (size_t)frame->width, run_line, &job, frame->cancel);
}

static double dn_of(const pl_view *view, double electrons) {
  const double linear = electrons / pl_sensor_white_electrons(view->sensor);
  return pl_view_dn(view, linear * view->white_radiance);
}

/* Largest factor on light from flat fields and response non-uniformity. */
static double response_gain(const pl_view *view) {
  double low, high;
  pl_shading_range(&view->sensor->shading, view->corner_tangent, &low, &high);
  return fmax(1.0, high) * (1.0 + PL_SENSOR_SIGMAS * view->sensor->prnu);
}

/* Also includes smear. */
static double light_gain(const pl_view *view) {
  const pl_sensor *s = view->sensor;
  const double smear = s->exposure_s > 0.0 ? view->height * s->shift_s / s->exposure_s : 0.0;
  return response_gain(view) * (1.0 + smear);
}

double pl_sensor_light_dn(const pl_view *view, double electrons) {
  return dn_of(view, light_gain(view) * electrons);
}

double pl_sensor_white_radiance(const pl_view *view) {
  const double response = light_gain(view) * pl_sensor_response_white(view->sensor);
  return response > 0.0 ? pl_sensor_white_electrons(view->sensor) / response : INFINITY;
}

double pl_sensor_dn(const pl_view *view, double electrons) {
  double balance = 1.0;
  for (int band = 0; band < 3; band++)
    balance = fmax(balance, pl_sensor_balance(view->sensor, band));
  return dn_of(view, balance * electrons);
}

/* Light x is read as y = x - n, where n is noise; dimmed, it is read as y - f y - f n. The change
 * is at most E(y) - E((1 - f) y) plus E(f n), since the encoding E is concave. */
double pl_sensor_dimming_dn(const pl_view *view, double fraction) {
  const pl_sensor *s = view->sensor;
  const double noise = PL_SENSOR_SIGMAS * pl_sensor_read_deviation(s);
  const double bared = pl_sensor_dn(view, fraction * noise);
  return fmin(255.0, pl_view_dn_dimming(fraction) + bared);
}

double pl_sensor_radiance_max(const pl_view *view) {
  const double gathered = 4.0; /* stars that the point-spread function adds in one pixel */
  double radiance = 0.0;
  if (view->sun_in_frame || pl_view_alpha_min(view) < 1.0)
    return INFINITY;
  for (size_t i = 0; i < view->entity_count; i++)
    if (view->entities[i].in_frame)
      radiance = fmax(radiance, pl_view_light(&view->entities[i]) + pl_view_received(view, i));
  radiance *= pl_view_series(view, 1 + view->max_bounces);
  radiance += pl_view_media_max(view);
  return radiance + gathered * pl_view_sky_max(view);
}

double pl_sensor_electrons_max(const pl_view *view) {
  if (!(view->sensor->exposure_s > 0.0))
    return 0.0;
  const double scene = pl_sensor_radiance_max(view);
  const double radiance = scene + pl_flare_radiance_max(view, scene);
  return radiance * pl_sensor_response_white(view->sensor);
}

double pl_sensor_light_max(const pl_view *view) {
  return response_gain(view) * pl_sensor_electrons_max(view);
}

double pl_sensor_charge_max(const pl_view *view) {
  const pl_sensor *s = view->sensor;
  const double light = light_gain(view) * pl_sensor_electrons_max(view);
  const double hot = s->hot_pixels > 0.0 ? 1.5 * s->hot_current * s->exposure_s : 0.0;
  const double mean = light + pl_sensor_dark_max(s) + hot;
  return pl_poisson_most(mean) + pl_sensor_rays_max(view);
}

const char *pl_sensor_absent(const pl_view *view) {
  return view->sensor == NULL ? "no sensor is configured, or none of its channels is requested"
                              : NULL;
}

double pl_sensor_cost_ms(const pl_view *view, double ns) {
  return 1e-6 * ns * view->width * view->height;
}
