/* Bands of a camera: conversion of a pixel's colours to radiance per band. */
#ifndef PL_SENSOR_BANDS_H
#define PL_SENSOR_BANDS_H

#include <stddef.h>

#include "math/vec.h"

enum { PL_BANDS_MAX = 64 };

/* out[count][bands]: radiance in each band, W m-2 sr-1. radiance: `count` pixels as the renderers
 * produce them, where each colour is scaled as if it reflected all sunlight. parts: by band, the
 * contribution of each colour (pl_band_light). */
void pl_bands_write(const float parts[][3], int bands, const pl_vec3f *radiance, size_t count,
                    float *out);

#endif
