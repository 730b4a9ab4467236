/* Deflate (RFC 1951) of whole arrays by libdeflate, which takes a part of zlib's time. */
#ifndef PL_IO_DEFLATE_H
#define PL_IO_DEFLATE_H

#include <stddef.h>

#include "base/bytes.h"
#include "base/status.h"

typedef enum pl_deflate_form {
  PL_DEFLATE_RAW, /* the stream alone, as zip archives have it */
  PL_DEFLATE_ZLIB /* with the header and the sum of zlib (RFC 1950), as OpenEXR and HDF5 have it */
} pl_deflate_form;

/* Appends a stream to `out`. The same input gives the same bytes with the same libdeflate.
 * Reentrant. PL_E_MEMORY. */
pl_status pl_deflate(const void *data, size_t size, pl_deflate_form form, pl_bytes *out);

#endif
