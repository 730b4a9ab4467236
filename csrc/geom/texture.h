/* Filtered textures: a mip pyramid of 8-bit texels or floats, sampled by the footprint of a ray. */
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

/* Filters, from the cheapest. Each value is a mean of texels of the levels between which the
 * footprint's axes lie. The mip level of PL_FILTER_NEAREST to PL_FILTER_TRILINEAR follows the
 * longer axis; taps along that axis lower it towards that of the shorter one. */
typedef enum pl_filter {
  PL_FILTER_NONE,      /* the nearest texel of the finest level; aliases */
  PL_FILTER_NEAREST,   /* the nearest texel of the nearest level */
  PL_FILTER_BILINEAR,  /* four texels of the nearest level, interpolated */
  PL_FILTER_TRILINEAR, /* bilinear in the two levels around the footprint, interpolated */
  PL_FILTER_TAPS_2,    /* up to this many trilinear lookups along the longer axis */
  PL_FILTER_TAPS_4,
  PL_FILTER_TAPS_8,
  PL_FILTER_TAPS_16,
  PL_FILTER_COUNT,
  PL_FILTER_FINEST = PL_FILTER_COUNT - 1
} pl_filter;

typedef struct pl_texture pl_texture;

/* Takes ownership of the texels of `image` (which is cleared, also on failure). `srgb`: colour
 * channels are sRGB-encoded and are decoded to linear; alpha is always linear. */
pl_status pl_texture_create(pl_image *image, bool srgb, pl_wrap wrap_u, pl_wrap wrap_v,
                            pl_texture **out);
/* Creates a texture of one channel of finite floats of any range, without rounding to 8 bits (for
 * heights); top row first, copied. */
pl_status pl_texture_of_numbers(const float *numbers, int width, int height, pl_wrap wrap_u,
                                pl_wrap wrap_v, pl_texture **out);
void pl_texture_destroy(pl_texture *texture);

/* Filters the texture at (u, v), v downwards (glTF): RGBA, linear; grey is copied to RGB, missing
 * alpha is 1. The footprint is the parallelogram spanned by the uv vectors a and b (each a full
 * pixel wide); zero vectors select the finest level. */
void pl_texture_sample(const pl_texture *texture, float u, float v, const float a[2],
                       const float b[2], pl_filter filter, float out[4]);

/* As pl_texture_sample, but nearer to the exact mean over the footprint. For footprints that are
 * read once and not averaged with neighbours, such as a whole pixel. pl_texture_sample blurs by
 * more than the footprint, or not at all where that is one texel wide. Both are equal for filters
 * below PL_FILTER_TRILINEAR. The finest level that is read is that of a quarter of the shorter
 * axis. */
void pl_texture_box(const pl_texture *texture, float u, float v, const float a[2], const float b[2],
                    pl_filter filter, float out[4]);

/* Returns per mip level the largest difference between two texels in any one channel, 0..1, linear,
 * over that level and all coarser ones. It does not increase with the level and is 0 for the last
 * of `*levels`. It bounds the range of filtered values of footprints whose shorter axis is 2^k
 * texels or more. */
const float *pl_texture_ranges(const pl_texture *texture, int *levels);

/* Returns the mean of all texels (not weighted by latitude), RGBA, linear. */
void pl_texture_mean(const pl_texture *texture, float out[4]);
/* Finds the smallest and largest alpha, 0..1, of the texels that bilinear lookups in the finest
 * level read anywhere in the box from `low` to `high` (u, v); at most of all texels. */
void pl_texture_alpha_range(const pl_texture *texture, const float low[2], const float high[2],
                            float range[2]);
void pl_texture_size(const pl_texture *texture, int *width, int *height, int *channels);
size_t pl_texture_bytes(const pl_texture *texture);

#ifdef __cplusplus
}
#endif
#endif
