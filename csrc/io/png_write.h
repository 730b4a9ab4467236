/* Writes PNG: 8 and 16 bits, grey to RGBA, and 8-bit palettes; byte-identical for identical input.
 */
#ifndef PL_IO_PNG_WRITE_H
#define PL_IO_PNG_WRITE_H

#include <stdint.h>

#include "base/bytes.h"
#include "base/status.h"

/* Writes to a temporary file beside `path` and renames it, so that no incomplete file is ever
 * visible. `bits` is 8 (uint8 samples) or 16 (native uint16 samples); `channels` 1..4; `level` is
 * that of zlib, 0..9. */
pl_status pl_png_write(const char *path, const void *samples, int width, int height, int channels,
                       int bits, int level);

/* The same into memory: `out` must be empty, and is the caller's to clear, also after an error.
 * `palette` has `palette_count` colours (RGB, 8 bits) for samples of one channel of 8 bits, all of
 * which must be below `palette_count`; NULL: none. `name` stands in errors. */
pl_status pl_png_encode(const char *name, const void *samples, int width, int height, int channels,
                        int bits, int level, const uint8_t *palette, int palette_count,
                        pl_bytes *out);

#endif
