/* Adjustments of an image's texels before it is filtered. */
#ifndef PL_GEOM_IMAGE_LEVELS_H
#define PL_GEOM_IMAGE_LEVELS_H

#include "geom/image.h"

/* Finds the black level of each channel of an equirectangular sRGB-encoded map of night lights,
 * linear: the value that a twentieth of the body's area exceeds, but at most PL_BLACK_MOST. In
 * published maps less than a twentieth is lit; the rest has a moonlight tint or is black. */
#define PL_BLACK_MOST 0.02f
void pl_image_find_black(const pl_image *image, float black[3]);
/* Raises the black level: in sRGB-encoded channels (not alpha) values up to `black` (0..1, linear)
 * become 0, and the rest is stretched to 0..1. */
void pl_image_raise_black(pl_image *image, const float black[3]);

/* Replaces a coloured map by a mask of one channel: by how much linear blue exceeds 1.5 times
 * linear red; white from 2.5 times on. Returns PL_E_RANGE for grey images, which are not
 * changed. */
pl_status pl_image_to_water(pl_image *image);

#endif
