/* Writes PNG: 8-bit grey/RGB/RGBA and 16-bit grey, byte-identical for identical input. */
#ifndef PL_IO_PNG_WRITE_H
#define PL_IO_PNG_WRITE_H

#include <stdint.h>

#include "base/status.h"

/* Writes to a temporary file beside `path` and renames it, so that no incomplete file is ever
 * visible. `bits` is 8 (uint8 samples) or 16 (native uint16 samples); `channels` 1..4; `level` is
 * that of zlib, 0..9. */
pl_status pl_png_write(const char *path, const void *samples, int width, int height, int channels,
                       int bits, int level);

#endif
