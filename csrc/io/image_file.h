/* Reads PNG, JPEG and WebP images from files and from memory. */
#ifndef PL_IO_IMAGE_FILE_H
#define PL_IO_IMAGE_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "geom/image.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Decodes PNG, JPEG or WebP (detected by their signature). 16-bit samples are reduced to 8,
 * palettes are expanded. Fails for more than 2^28 texels, and for invalid or truncated data
 * (PL_E_FORMAT); other formats give PL_E_UNSUPPORTED with the format named. `name` is used in error
 * texts. */
pl_status pl_image_decode(const uint8_t *bytes, size_t size, const char *name, pl_image *out);
/* Decodes a grey PNG of any depth to 16 bits, without loss: two channels, the high and the low byte
 * (n-bit values are scaled so that their maximum becomes 65535). Returns PL_E_UNSUPPORTED for
 * colour images; otherwise as pl_image_decode. */
pl_status pl_png_decode_grey(const uint8_t *bytes, size_t size, const char *name, pl_image *out);
/* As pl_image_decode, but from a file; returns PL_E_IO with the path when it cannot be read. */
pl_status pl_image_load(const char *path, pl_image *out);

#ifdef __cplusplus
}
#endif
#endif
