/* Changes of an image's texels before it is filtered. */
#ifndef PL_GEOM_IMAGE_LEVELS_H
#define PL_GEOM_IMAGE_LEVELS_H

#include "geom/image.h"

/* Moves black up: of sRGB-encoded channels (not alpha) what is at most `black` (0..1, linear)
 * becomes 0, and the rest is stretched to 0..1 again. */
void pl_image_raise_black(pl_image *image, float black);

/* A mask of one channel in the place of a coloured map: how far linear blue exceeds 1.5 times
 * linear red; white from 2.5 times on. PL_E_RANGE for grey images, which are left as they are. */
pl_status pl_image_to_water(pl_image *image);

#endif
