/* The mask of shadows: which points of the geometry buffer do not see the centre of the sun. */
#ifndef PL_RENDER_SHADOW_MASK_H
#define PL_RENDER_SHADOW_MASK_H

#include "render/path.h"

/* Sets in_shadow of all points of the tile. It is geometry: no effect of the plan switches it, and
 * it does not depend on samples. Uses the buffers of shadow rays. */
void pl_shadow_mask(const pl_path_context *context, pl_tile_buffers *buffers);

#endif
