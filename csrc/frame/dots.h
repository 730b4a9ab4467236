/* Bodies of a few pixels: too small for the samples of pixels, which would miss them or not. */
#ifndef PL_FRAME_DOTS_H
#define PL_FRAME_DOTS_H

#include "frame/renderer.h"

/* Marks the bodies of `shot` that are so small in the image and may show by an eighth of the
 * tolerance or more. Camera rays that meet them see black from then on. */
void pl_dots_mark(pl_snapshot *shot, const pl_view *view, double tolerance_dn);

/* Renders each of them in a picture of its own, and lists what that adds to the frame's pixels in
 * `sky`, so that the whole frame gets the light that the body sends. The tracer is set to `shot`,
 * before and after. `settings`: the frame's. Memory is the arena's. */
pl_status pl_dots_render(pl_renderer *renderer, const pl_snapshot *shot,
                         const pl_render_settings *settings, pl_arena *arena, pl_cancel *cancel,
                         pl_frame_sky *sky);

#endif
