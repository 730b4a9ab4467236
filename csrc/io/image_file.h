/* Reading PNG, JPEG and WebP images, from files and from memory. */
#ifndef PL_IO_IMAGE_FILE_H
#define PL_IO_IMAGE_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "geom/image.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Decodes PNG, JPEG or WebP (told apart by their first bytes). 16-bit samples are reduced to 8,
 * palettes are expanded. Refuses more than 2^28 texels, and broken or truncated data (PL_E_FORMAT);
 * other formats are PL_E_UNSUPPORTED with the format named. `name` is used in error texts. */
pl_status pl_image_decode(const uint8_t *bytes, size_t size, const char *name, pl_image *out);
/* Decodes a grey PNG of any depth to 16 bits, without loss: two channels, the high and the low byte
 * (a depth of n bits is multiplied so that its largest number is 65535). PL_E_UNSUPPORTED for
 * colours; else as above. */
pl_status pl_png_decode_grey(const uint8_t *bytes, size_t size, const char *name, pl_image *out);
/* The same as pl_image_decode from a file; PL_E_IO with the path when it cannot be read. */
pl_status pl_image_load(const char *path, pl_image *out);

#ifdef __cplusplus
}
#endif
#endif
