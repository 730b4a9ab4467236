/* Decoders behind pl_image_decode, one per format. Internal to io. */
#ifndef PL_IO_IMAGE_CODEC_H
#define PL_IO_IMAGE_CODEC_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "geom/image.h"

/* Precondition of all: the signature of the format has been checked. They leave *out empty on
 * failure. */
pl_status pl_png_decode(const uint8_t *bytes, size_t size, const char *name, pl_image *out);
pl_status pl_jpeg_decode(const uint8_t *bytes, size_t size, const char *name, pl_image *out);
pl_status pl_webp_decode(const uint8_t *bytes, size_t size, const char *name, pl_image *out);

/* Checks a size read from a header before anything is allocated: at most 2^28 texels, and
 * `sample_bytes` (the size of the decoded samples) at most `expansion` times the size of the
 * file. */
pl_status pl_image_check_size(const char *name, uint64_t width, uint64_t height,
                              uint64_t sample_bytes, uint64_t size, uint64_t expansion);

#endif
