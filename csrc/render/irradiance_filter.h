/* The irradiance filter: means over neighbouring pixels of the light in irradiance_record.h. */
#ifndef PL_RENDER_IRRADIANCE_FILTER_H
#define PL_RENDER_IRRADIANCE_FILTER_H

#include "render/irradiance_record.h"

/* Writes the radiance of a tile that has `lit` set. It and all tiles around it must be held. */
void pl_irradiance_filter_light(const pl_irradiance_record *irradiance, int row, int column,
                                const pl_render_settings *settings, double pixel_rad,
                                pl_vec3f radiance[PL_TILE_PIXELS]);

#endif
