/* Applies the losses of JPEG compression to an image: encodes and decodes it in memory. */
#ifndef PL_IO_JPEG_WRITE_H
#define PL_IO_JPEG_WRITE_H

#include <stdint.h>

#include "base/memory.h"
#include "base/status.h"
#include "sensor/sensor.h"

/* Replaces RGB pixels (row-major, 3 bytes each) by their values after baseline JPEG compression
 * with the tables of ITU-T T.81, annex K. Uses the accurate integer transform, so that a version of
 * the library gives the same bits on all machines. `arena` holds the compressed file temporarily;
 * the library's own memory, a few rows, is not allocated through the allocation hook. Sides are at
 * most 65500. */
pl_status pl_jpeg_cycle(const pl_compression *compression, int width, int height, pl_arena *arena,
                        uint8_t *rgb);

#endif
