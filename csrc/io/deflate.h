/* Deflate (RFC 1951) for arrays: runs of pixels that repeat the one before, words that were met
 * before, and Huffman codes. It passes over what does not repeat in words, so that it takes a small
 * part of zlib's time. */
#ifndef PL_IO_DEFLATE_H
#define PL_IO_DEFLATE_H

#include <stddef.h>

#include "base/bytes.h"
#include "base/status.h"

enum { PL_DEFLATE_MAX_STRIDE = 32768 };

/* Appends a stream to `out`. `stride`: bytes from a pixel to the next, 1..PL_DEFLATE_MAX_STRIDE.
 * Blocks that would hardly become smaller are stored. The same input gives the same bytes.
 * Reentrant. PL_E_RANGE for another stride, PL_E_MEMORY. */
pl_status pl_deflate(const void *data, size_t size, size_t stride, pl_bytes *out);

/* The same with the header and the sum of zlib (RFC 1950). */
pl_status pl_deflate_zlib(const void *data, size_t size, size_t stride, pl_bytes *out);

#endif
