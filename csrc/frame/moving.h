/* Frames in which the world moves while the shutter is open: motion blur and rolling shutters.
 *
 * The time of the frame runs from the opening of the first row to the closing of the last. With
 * blur it is divided evenly into instants; each is static, and renders the samples of pixels that
 * fall into it. Without blur, bands of rows are rendered, each at the middle of its own exposure.
 * Labels are valid at the middle of each row's exposure; poses, 3-D boxes and occluded parts of
 * silhouettes at the middle of the frame. */
#ifndef PL_FRAME_MOVING_H
#define PL_FRAME_MOVING_H

#include "frame/output.h"
#include "frame/renderer.h"

/* Returns whether the plan keeps motion blur or the rolling shutter. */
bool pl_moving(const pl_frame_request *request, const pl_plan *plan);

/* Returns whether the plan renders rows of labels at times of their own. */
bool pl_moving_rolls(const pl_frame_request *request, const pl_plan *plan);

/* Changes the plan of the middle instant, whose view is given, so that it suits all instants: each
 * row gets the most demanding value over several views. */
pl_status pl_moving_plan(pl_renderer *renderer, const pl_frame_request *request,
                         const pl_view *middle, bool colour, pl_plan *plan);

/* Places the world at the fraction `u` of the frame's time, and realises it with a choice that the
 * plan allows. Sets the sky of that instant, with its light if the choice is in colour. All is
 * valid until the next instant, and has the exposures of `middle`. */
pl_status pl_moving_realise(pl_renderer *renderer, const pl_frame_request *request,
                            const pl_plan *plan, const pl_view *middle, double u,
                            const pl_choice *choice, pl_frame_sky *sky, const pl_instant **out);

/* Renders a frame from what pl_renderer_frame has prepared. `view` and `instant` belong to the
 * middle of the frame; `choice` is used for every instant. */
pl_status pl_moving_render(pl_renderer *renderer, const pl_frame_request *request,
                           const pl_plan *plan, const pl_view *view, const pl_choice *choice,
                           const pl_instant *instant, pl_output *output);

#endif
