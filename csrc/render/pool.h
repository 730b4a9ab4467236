/* Pools of light that is shared between pixels, see share.h. */
#ifndef PL_RENDER_POOL_H
#define PL_RENDER_POOL_H

#include "render/share.h"

/* Radiance of a tile that is lit, when all are kept. */
void pl_pool_light(const pl_share *share, size_t item, const pl_render_settings *settings,
                   double pixel_rad, pl_vec3f radiance[PL_TILE_PIXELS]);

#endif
