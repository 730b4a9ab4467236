#include "io/deflate.h"

#include <libdeflate.h>

/* The fastest that compresses. */
enum { LEVEL = 1 };

static size_t compress(struct libdeflate_compressor *by, pl_deflate_form form, const void *data,
                       size_t size, void *out, size_t room) {
  return form == PL_DEFLATE_ZLIB ? libdeflate_zlib_compress(by, data, size, out, room)
                                 : libdeflate_deflate_compress(by, data, size, out, room);
}

pl_status pl_deflate(const void *data, size_t size, pl_deflate_form form, pl_bytes *out) {
  struct libdeflate_compressor *by = libdeflate_alloc_compressor(LEVEL);
  if (by == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for compressing %zu bytes", size);
  const size_t room = form == PL_DEFLATE_ZLIB ? libdeflate_zlib_compress_bound(by, size)
                                              : libdeflate_deflate_compress_bound(by, size);
  const pl_status status = pl_bytes_reserve(out, room);
  if (status == PL_OK)
    out->size += compress(by, form, data, size, out->data + out->size, room);
  libdeflate_free_compressor(by);
  return status;
}
