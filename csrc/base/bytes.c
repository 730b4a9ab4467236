/* A growing array of bytes. */
#include "base/bytes.h"

#include <string.h>

#include "base/memory.h"

enum { FIRST_CAPACITY = 4096 };

/* Makes room for `count` bytes at an offset. */
static pl_status make_room(pl_bytes *bytes, size_t offset, size_t count) {
  if (count > SIZE_MAX / 2 || offset > SIZE_MAX / 2 - count)
    return pl_fail(PL_E_MEMORY, "a file in memory of more than half of all memory");
  const size_t end = offset + count;
  if (end <= bytes->capacity)
    return PL_OK;
  size_t capacity = bytes->capacity > 0 ? bytes->capacity : FIRST_CAPACITY;
  while (capacity < end)
    capacity *= 2;
  uint8_t *data = pl_realloc(bytes->data, capacity, 1);
  if (data == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for a file of %zu bytes", end);
  bytes->data = data;
  bytes->capacity = capacity;
  return PL_OK;
}

pl_status pl_bytes_reserve(pl_bytes *bytes, size_t count) {
  return make_room(bytes, bytes->size, count);
}

pl_status pl_bytes_put(pl_bytes *bytes, size_t offset, const void *from, size_t count) {
  PL_TRY(make_room(bytes, offset, count));
  const size_t end = offset + count;
  if (offset > bytes->size)
    memset(bytes->data + bytes->size, 0, offset - bytes->size);
  if (count > 0)
    memcpy(bytes->data + offset, from, count);
  bytes->size = end > bytes->size ? end : bytes->size;
  return PL_OK;
}

void pl_bytes_clear(pl_bytes *bytes) {
  pl_free(bytes->data);
  *bytes = (pl_bytes){0};
}
