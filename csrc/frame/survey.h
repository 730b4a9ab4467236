/* What a placement is about to show: all that a plan is made of. Nothing heavy is built for it. */
#ifndef PL_FRAME_SURVEY_H
#define PL_FRAME_SURVEY_H

#include "frame/frame.h"
#include "frame/sky.h"

typedef struct pl_survey {
  pl_snapshot shot; /* with everything in it, and all that the camera has */
  pl_view view;     /* of it */
  pl_frame_sky sky; /* its part before the plan */
} pl_survey;

/* Places the scene and tells the view what the request asks for: exposures, the shutter and the sky
 * are still to come. In `arena`; borrows scene and placement. */
pl_status pl_survey_place(const pl_scene *scene, const pl_frame_request *request,
                          const pl_placement *placement, pl_arena *arena, pl_survey *out);

/* The world at a part `u` of the frame's time, by the exposures of its middle. `lods`: what other
 * lods of reflectance make of it is measured, too. */
pl_status pl_survey_at(const pl_scene *scene, const pl_frame_request *request, double u,
                       const pl_view *middle, bool lods, pl_arena *arena, pl_survey *out);

#endif
