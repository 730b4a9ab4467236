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

/* How a footprint is read, from the cheapest; each value is a mean of texels of the levels that the
 * footprint's axes lie between. The mip level of PL_FILTER_NEAREST to PL_FILTER_TRILINEAR goes by
 * the longer axis; taps along that axis bring it down towards the shorter. */
typedef enum pl_filter {
  PL_FILTER_NONE,      /* the nearest texel of the image itself: aliases */
  PL_FILTER_NEAREST,   /* the nearest texel of the nearest level */
  PL_FILTER_BILINEAR,  /* four texels of the nearest level */
  PL_FILTER_TRILINEAR, /* four of each of the two levels about the footprint */
  PL_FILTER_TAPS_2,    /* up to so many trilinear reads along the longer axis */
  PL_FILTER_TAPS_4,
  PL_FILTER_TAPS_8,
  PL_FILTER_TAPS_16,
  PL_FILTER_COUNT,
  PL_FILTER_FINEST = PL_FILTER_COUNT - 1
} pl_filter;

typedef struct pl_texture pl_texture;

/* Takes over the texels of `image` (cleared, also on failure). `srgb`: colour channels are
 * sRGB-encoded and come out linear; alpha is always linear. */
pl_status pl_texture_create(pl_image *image, bool srgb, pl_wrap wrap_u, pl_wrap wrap_v,
                            pl_texture **out);
/* A texture of one channel of finite numbers of any range, which 8 bits do not cut (heights); rows
 * from the top, copied. */
pl_status pl_texture_of_numbers(const float *numbers, int width, int height, pl_wrap wrap_u,
                                pl_wrap wrap_v, pl_texture **out);
void pl_texture_destroy(pl_texture *texture);

/* The filtered value at (u, v), v downwards (glTF): RGBA, linear; grey spreads to RGB, missing
 * alpha is 1. The footprint is the parallelogram spanned by the uv vectors a and b (a full pixel
 * wide each); pass zeros for the finest level. */
void pl_texture_sample(const pl_texture *texture, float u, float v, const float a[2],
                       const float b[2], pl_filter filter, float out[4]);

/* The same, nearer to the mean over the footprint: for one that is read once and is not averaged
 * with its neighbours, as of a whole pixel. pl_texture_sample blurs by more than the footprint, or
 * not at all where that is a texel wide. With filters below PL_FILTER_TRILINEAR the same. Reads no
 * finer a level than that of a quarter of the shorter axis. */
void pl_texture_box(const pl_texture *texture, float u, float v, const float a[2], const float b[2],
                    pl_filter filter, float out[4]);

/* Largest difference between two texels in any one channel, 0..1, linear: of each mip level and all
 * coarser ones together. Not growing; 0 for the last of `*levels`. What filters read of a
 * footprint whose shorter axis is 2^k texels or more lies that close together. */
const float *pl_texture_ranges(const pl_texture *texture, int *levels);

/* The mean of all texels (area mean: not weighted by latitude), RGBA, linear. */
void pl_texture_mean(const pl_texture *texture, float out[4]);
/* Smallest and largest alpha, 0..1, of the texels that bilinear lookups of the image itself read
 * anywhere in the box from `low` to `high` (u, v); at most of all texels. */
void pl_texture_alpha_range(const pl_texture *texture, const float low[2], const float high[2],
                            float range[2]);
void pl_texture_size(const pl_texture *texture, int *width, int *height, int *channels);
size_t pl_texture_bytes(const pl_texture *texture);

#ifdef __cplusplus
}
#endif
#endif
