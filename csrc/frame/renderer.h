/* Shared by the files of this folder: the renderer struct, and the stages of a frame. */
#ifndef PL_FRAME_RENDERER_H
#define PL_FRAME_RENDERER_H

#include "frame/frame.h"
#include "frame/instant.h"
#include "frame/labels.h"
#include "render/render.h"
#include "sensor/encode.h"

struct pl_renderer {
  const pl_scene *scene;         /* borrowed */
  pl_accelerators *accelerators; /* of the scene's models */
  pl_label_tools label_tools;
  pl_render_scratch *scratch;
  pl_arena arena;
  pl_arena sensor_arena; /* for one image of the sensor */
  pl_arena instants;     /* for one instant of a moving frame */
  pl_encoder encoder;
  size_t missed; /* pixels of this frame above the target */
};

/* Makes the plan. `metered`: automatic exposures are measured; they are not when only labels are
 * requested, which no effect changes. `sensor`: set to the request's with its exposure time, if
 * `developed`. */
pl_status pl_frame_plan(pl_renderer *renderer, const pl_frame_request *request, bool metered,
                        bool developed, pl_survey *survey, pl_sensor *sensor,
                        pl_frame_result *result);

/* First step from an instant to pixels: prepares the light of the sky, i.e. of sub-pixel bodies (if
 * `subpixel`) and of the stars that the plan keeps and nothing hides. Allocated in `arena`; `sky`
 * belongs to the instant's survey. */
pl_status pl_frame_light_sky(pl_renderer *renderer, const pl_frame_request *request,
                             const pl_plan *plan, const pl_instant *instant, bool subpixel,
                             pl_arena *arena, pl_frame_sky *sky);
/* Second step: renders the tiles. */
pl_status pl_frame_render(pl_renderer *renderer, const pl_frame_request *request,
                          const pl_instant *instant, const pl_frame_sky *sky, pl_tile_fn done,
                          void *context);

/* Measures automatic exposures on a small image of the same instant with direct light only. Sets
 * *white_radiance if the request's exposure is automatic, and the exposure time of `sensor` (NULL:
 * none) if its is. `fallback` is the radiance of a sunlit white surface. */
pl_status pl_frame_meter(pl_renderer *renderer, const pl_frame_request *request,
                         const pl_survey *survey, double fallback, double *white_radiance,
                         pl_sensor *sensor);

/* Returns whether the request has outputs of the sensor. */
bool pl_frame_wants_sensor(const pl_frame_request *request);
/* Passes `bands` (radiance, row-major; modified) of a rendered instant through the sensor's stages
 * and writes the request's arrays. */
pl_status pl_frame_develop(pl_renderer *renderer, const pl_frame_request *request,
                           const pl_instant *instant, const pl_sensor *sensor, const pl_plan *plan,
                           pl_vec3f *bands);

#endif
