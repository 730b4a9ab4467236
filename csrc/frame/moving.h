/* Frames whose world moves while the shutter is open: motion blur and rolling shutters.
 *
 * The time of the frame goes from the opening of the first row to the closing of the last. With
 * blur it is cut into instants, evenly; at each the world stands, and those samples of pixels are
 * drawn whose time it is. Without blur bands of rows are drawn, each at the middle of its own
 * exposure. Labels are of the middle of each row's exposure; poses, boxes of 3-D things and hidden
 * parts of silhouettes of the middle of the whole. */
#ifndef PL_FRAME_MOVING_H
#define PL_FRAME_MOVING_H

#include "frame/output.h"
#include "frame/renderer.h"

/* Whether the plan keeps any of it. */
bool pl_moving(const pl_frame_request *request, const pl_plan *plan);

/* Makes the plan of the middle, whose view is given, one that suits all instants: of each row what
 * the most demanding of several views wants. */
pl_status pl_moving_plan(pl_renderer *renderer, const pl_frame_request *request,
                         const pl_view *middle, bool colour, pl_plan *plan);

/* Renders a frame by what pl_renderer_frame has prepared. `view`, `instant`: of the middle;
 * `choice`: what is made of every instant. */
pl_status pl_moving_render(pl_renderer *renderer, const pl_frame_request *request,
                           const pl_plan *plan, const pl_view *view, const pl_choice *choice,
                           const pl_instant *instant, pl_output *output);

#endif
