/* What the files of this folder share: the renderer's inside, and the steps of a frame. */
#ifndef PL_FRAME_RENDERER_H
#define PL_FRAME_RENDERER_H

#include "frame/frame.h"
#include "frame/labels.h"
#include "render/render.h"
#include "sensor/encode.h"

struct pl_renderer {
  const pl_scene *scene; /* borrowed */
  pl_tracer *tracer;
  pl_label_tools label_tools;
  pl_render_scratch *scratch;
  pl_arena arena;
  pl_arena sensor_arena; /* of one of a sensor's images */
  pl_arena instants;     /* what one instant of a moving frame needs */
  pl_encoder encoder;
};

/* Tells the view what the request asks for. */
void pl_frame_view_wants(const pl_frame_request *request, pl_view *view);
/* Takes from a snapshot's camera what the plan leaves out. */
void pl_frame_apply(const pl_plan *plan, pl_snapshot *shot);

/* Lists the emitters where the settings want them: `wanted` is the value of that effect. */
pl_status pl_frame_emitters(pl_arena *arena, const pl_snapshot *shot, int wanted,
                            pl_emitters *emitters, pl_render_settings *settings);

/* Lists the airs where the plan (NULL: a quick look) wants them. */
pl_status pl_frame_air(pl_arena *arena, const pl_snapshot *shot, const pl_plan *plan,
                       pl_air_view *air, pl_render_settings *settings);

/* Lists the veils likewise; the airs are listed already. */
pl_status pl_frame_veils(pl_arena *arena, const pl_snapshot *shot, const pl_plan *plan,
                         pl_veils *veils, pl_render_settings *settings);

/* Lists the bodies that light others where the plan wants them. */
pl_status pl_frame_planetshine(pl_arena *arena, const pl_snapshot *shot, const pl_plan *plan,
                               pl_planetshine *shine, pl_render_settings *settings);

/* Lists what mirrors the sun onto others where the plan wants it; the tracer is set. */
void pl_frame_caustics(const pl_renderer *renderer, const pl_snapshot *shot, const pl_plan *plan,
                       pl_caustics *caustics, pl_render_settings *settings);

/* Exposures that are automatic, measured on the same frame, small, by direct light only: sets
 * *white_radiance where the request's is, and the exposure time of `sensor` (NULL: none) where its
 * is. `fallback` is the radiance of a sunlit white surface. */
pl_status pl_frame_meter(pl_renderer *renderer, const pl_frame_request *request,
                         const pl_snapshot *shot, double fallback, double *white_radiance,
                         pl_sensor *sensor);

/* Whether the request asks for what a sensor makes. */
bool pl_frame_wants_sensor(const pl_frame_request *request);
/* Takes `bands` (radiance, row-major; changed) of a rendered snapshot through the sensor to the
 * request's arrays. */
pl_status pl_frame_develop(pl_renderer *renderer, const pl_frame_request *request,
                           const pl_snapshot *shot, const pl_sensor *sensor, const pl_plan *plan,
                           pl_vec3f *bands);

#endif
