/* Bodies of a few pixels: too small for the samples of pixels, which would miss them or not. */
#ifndef PL_FRAME_SUBPIXEL_BODIES_H
#define PL_FRAME_SUBPIXEL_BODIES_H

#include "frame/instant.h"

/* Finds the bodies of `shot` that are so small in the image and may show by an eighth of the
 * tolerance or more: one each. In `arena`. Camera rays that meet them see black. */
pl_status pl_subpixel_find(const pl_snapshot *shot, const pl_view *view, double tolerance_dn,
                           pl_arena *arena, const bool **out);

/* Renders each of them in a picture of its own, and lists what that adds to the frame's pixels in
 * `sky`, so that the whole frame gets the light that the body sends. Memory is the arena's. */
pl_status pl_subpixel_render(const pl_instant *instant, pl_render_scratch *scratch, pl_arena *arena,
                             pl_cancel *cancel, pl_frame_sky *sky);

#endif
