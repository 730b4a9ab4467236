/* What the files of this folder share: the renderer's inside, and the steps of a frame. */
#ifndef PL_FRAME_RENDERER_H
#define PL_FRAME_RENDERER_H

#include "frame/frame.h"
#include "frame/instant.h"
#include "frame/labels.h"
#include "render/render.h"
#include "sensor/encode.h"

struct pl_renderer {
  const pl_scene *scene;         /* borrowed */
  pl_accelerators *accelerators; /* of its models */
  pl_label_tools label_tools;
  pl_render_scratch *scratch;
  pl_arena arena;
  pl_arena sensor_arena; /* of one of a sensor's images */
  pl_arena instants;     /* what one instant of a moving frame needs */
  pl_encoder encoder;
};

/* From an instant to pixels: first what the sky has of it, small bodies too (`subpixel`) and the
 * stars that the plan keeps and nothing hides. In `arena`. `sky`: of the instant's survey. */
pl_status pl_frame_light_sky(pl_renderer *renderer, const pl_frame_request *request,
                             const pl_plan *plan, const pl_instant *instant, bool subpixel,
                             pl_arena *arena, pl_frame_sky *sky);
/* Then its tiles. */
pl_status pl_frame_render(pl_renderer *renderer, const pl_frame_request *request,
                          const pl_instant *instant, const pl_frame_sky *sky, pl_tile_fn done,
                          void *context);

/* Exposures that are automatic, measured on the same instant, small, by direct light only: sets
 * *white_radiance where the request's is, and the exposure time of `sensor` (NULL: none) where its
 * is. `fallback` is the radiance of a sunlit white surface. */
pl_status pl_frame_meter(pl_renderer *renderer, const pl_frame_request *request,
                         const pl_survey *survey, double fallback, double *white_radiance,
                         pl_sensor *sensor);

/* Whether the request asks for what a sensor makes. */
bool pl_frame_wants_sensor(const pl_frame_request *request);
/* Takes `bands` (radiance, row-major; changed) of a rendered instant through the sensor to the
 * request's arrays. */
pl_status pl_frame_develop(pl_renderer *renderer, const pl_frame_request *request,
                           const pl_instant *instant, const pl_sensor *sensor, const pl_plan *plan,
                           pl_vec3f *bands);

#endif
