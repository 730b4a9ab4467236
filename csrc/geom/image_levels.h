/* Changes of an image's texels before it is filtered. */
#ifndef PL_GEOM_IMAGE_LEVELS_H
#define PL_GEOM_IMAGE_LEVELS_H

#include "geom/image.h"

/* How bright the dark ground of an equirectangular sRGB-encoded map is, by channel, linear: what a
 * twentieth of the body's area exceeds, but no more than PL_BLACK_MOST. Of published maps of lights
 * by night less than that is lit; the rest is tinted as by moonlight, or black. */
#define PL_BLACK_MOST 0.02f
void pl_image_find_black(const pl_image *image, float black[3]);
/* Moves black up: of sRGB-encoded channels (not alpha) what is at most `black` (0..1, linear)
 * becomes 0, and the rest is stretched to 0..1 again. */
void pl_image_raise_black(pl_image *image, const float black[3]);

/* A mask of one channel in the place of a coloured map: how far linear blue exceeds 1.5 times
 * linear red; white from 2.5 times on. PL_E_RANGE for grey images, which are left as they are. */
pl_status pl_image_to_water(pl_image *image);

#endif
