/* A growing array of bytes: a file in memory. */
#ifndef PL_BASE_BYTES_H
#define PL_BASE_BYTES_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

/* Zero-initialised, it is empty. */
typedef struct pl_bytes {
  uint8_t *data; /* owned */
  size_t size, capacity;
} pl_bytes;

/* Writes `count` bytes at `offset`, which may be inside or beyond what is there; a gap is zeroed.
 * PL_E_MEMORY if there is no room; then nothing has changed. */
pl_status pl_bytes_put(pl_bytes *bytes, size_t offset, const void *from, size_t count);

/* Makes room for `count` bytes behind those that are there. PL_E_MEMORY if there is none. */
pl_status pl_bytes_reserve(pl_bytes *bytes, size_t count);

/* Frees everything. */
void pl_bytes_clear(pl_bytes *bytes);

#endif
