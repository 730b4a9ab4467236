/* Filtered textures: a mip pyramid over 8-bit texels, read by the footprint of a ray. */
#ifndef PL_GEOM_TEXTURE_H
#define PL_GEOM_TEXTURE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"
#include "geom/image.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum pl_wrap { PL_WRAP_REPEAT, PL_WRAP_CLAMP, PL_WRAP_MIRROR } pl_wrap;

typedef struct pl_texture pl_texture;

/* Takes over the texels of `image` (cleared, also on failure). `srgb`: colour channels are
 * sRGB-encoded and come out linear; alpha is always linear. */
pl_status pl_texture_create(pl_image *image, bool srgb, pl_wrap wrap_u, pl_wrap wrap_v,
                            pl_texture **out);
void pl_texture_destroy(pl_texture *texture);

/* The filtered value at (u, v), v downwards (glTF): RGBA, linear; grey spreads to RGB, missing
 * alpha is 1. The footprint is the parallelogram spanned by the uv vectors a and b (a full pixel
 * wide each); pass zeros for the finest level. Up to 16 taps along the longer axis. */
void pl_texture_sample(const pl_texture *texture, float u, float v, const float a[2],
                       const float b[2], float out[4]);

/* The mean of all texels (area mean: not weighted by latitude), RGBA, linear. */
void pl_texture_mean(const pl_texture *texture, float out[4]);
void pl_texture_size(const pl_texture *texture, int *width, int *height, int *channels);
size_t pl_texture_bytes(const pl_texture *texture);

#ifdef __cplusplus
}
#endif
#endif
