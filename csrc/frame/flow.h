/* Labels of points in frames: motion to the frames before and after, and keypoints. */
#ifndef PL_FRAME_FLOW_H
#define PL_FRAME_FLOW_H

#include "frame/renderer.h"

/* Places the other frames that the requested channels need, with the choice of this frame.
 * Allocated in the renderer's arena; *out is NULL if no channel of motion is requested. */
pl_status pl_frame_flow(pl_renderer *renderer, const pl_frame_request *request, const pl_plan *plan,
                        const pl_choice *choice, const pl_flow **out);

/* Labels the requested keypoints in the frame's middle instant. */
pl_status pl_frame_keypoints(const pl_scene *scene, const pl_frame_request *request,
                             const pl_plan *plan, const pl_instant *instant);

#endif
