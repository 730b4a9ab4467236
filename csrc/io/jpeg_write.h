/* What JPEG makes of an image: encoded and decoded again, in memory. */
#ifndef PL_IO_JPEG_WRITE_H
#define PL_IO_JPEG_WRITE_H

#include <stdint.h>

#include "base/memory.h"
#include "base/status.h"
#include "sensor/sensor.h"

/* Replaces RGB pixels (row-major, 3 bytes each) by what is left of them: baseline JPEG with the
 * tables of ITU-T T.81, annex K, by the accurate integer transform, so that a version of the
 * library gives the same bits everywhere. `arena` holds the file meanwhile; the library's own
 * working memory, a few rows, does not pass the allocation hook. Sides are at most 65500. */
pl_status pl_jpeg_cycle(const pl_compression *compression, int width, int height, pl_arena *arena,
                        uint8_t *rgb);

#endif
