/* The channel of clouds: how much of a pixel they hide. */
#ifndef PL_ANNOTATE_CLOUD_MAP_H
#define PL_ANNOTATE_CLOUD_MAP_H

#include "render/render.h"

/* Returns the image among those of pl_channels; NULL if it is not asked for. */
float *pl_cloud_map_find(void *const *channels);
/* Writes all pixels of a tile. `shot`: that of the tile's instant. */
void pl_cloud_map_write(float *image, const pl_snapshot *shot, const pl_tile_result *result);

#endif
