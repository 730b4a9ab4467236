/* Decoded images: 8-bit texels as stored in a file. */
#ifndef PL_GEOM_IMAGE_H
#define PL_GEOM_IMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Row 0 is the top row. Texels are interleaved, rows are tightly packed. */
typedef struct pl_image {
  int width, height; /* texels */
  int channels;      /* 1 grey, 2 grey+alpha, 3 RGB, 4 RGBA */
  uint8_t *texels;   /* owned (pl_alloc) */
} pl_image;

/* Allocates zeroed texels; returns PL_E_RANGE if a side is not in [1, 65536] or channels is not in
 * [1, 4]. */
pl_status pl_image_init(int width, int height, int channels, pl_image *out);
void pl_image_clear(pl_image *image);

#ifdef __cplusplus
}
#endif
#endif
