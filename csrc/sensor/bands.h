/* Bands of a camera: what it gathers of the light of a pixel. */
#ifndef PL_SENSOR_BANDS_H
#define PL_SENSOR_BANDS_H

#include <stddef.h>

#include "math/vec.h"

enum { PL_BANDS_MAX = 64 };

/* out[count][bands]: radiance in each band, W m-2 sr-1. radiance: of `count` pixels, each colour as
 * if all sunlight were reflected by it, as renderers give it. parts: by band, what the band
 * gathers of each colour (pl_band_light). */
void pl_bands_write(const float parts[][3], int bands, const pl_vec3f *radiance, size_t count,
                    float *out);

#endif
