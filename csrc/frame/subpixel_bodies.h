/* Sub-pixel bodies: bodies of less than a few pixels, which a pixel's samples may miss altogether.
 */
#ifndef PL_FRAME_SUBPIXEL_BODIES_H
#define PL_FRAME_SUBPIXEL_BODIES_H

#include "frame/instant.h"

/* Sets (*out)[b] for each body of `shot` that is this small in the image and that may change a
 * pixel by an eighth of the tolerance or more. Allocated in `arena`. Camera rays that meet such
 * bodies return black. */
pl_status pl_subpixel_find(const pl_snapshot *shot, const pl_view *view, double tolerance_dn,
                           pl_arena *arena, const bool **out);

/* Renders each of them in an image of its own, and lists in `sky` what it adds to pixels of the
 * frame. The frame so receives all the light of the body. Memory belongs to the arena. */
pl_status pl_subpixel_render(const pl_instant *instant, pl_render_scratch *scratch, pl_arena *arena,
                             pl_cancel *cancel, pl_frame_sky *sky);

#endif
