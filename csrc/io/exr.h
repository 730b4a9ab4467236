/* Writes OpenEXR files: scan lines of named channels, in memory. */
#ifndef PL_IO_EXR_H
#define PL_IO_EXR_H

#include <stddef.h>

#include "base/bytes.h"
#include "base/status.h"

/* Types of samples: those that OpenEXR has. */
typedef enum pl_exr_type { PL_EXR_UINT, PL_EXR_HALF, PL_EXR_FLOAT } pl_exr_type;

typedef struct pl_exr_channel {
  const char *name; /* "layer.component"; names differ */
  pl_exr_type type;
  const void *samples; /* row by row, without gaps; 4 bytes, or 2 for PL_EXR_HALF */
} pl_exr_channel;

typedef struct pl_exr_text {
  const char *name, *value; /* an attribute of the header, UTF-8 */
} pl_exr_text;

/* Encodes one part, compressed by ZIP in blocks of 16 lines, without loss. The same input gives the
 * same bytes. `out` must be empty, and is the caller's to clear, also after an error. Reentrant.
 * PL_E_RANGE for sides outside of 1..65536, no channel, or a name that is empty, longer than 255
 * bytes or there twice; PL_E_MEMORY. */
pl_status pl_exr_encode(int width, int height, const pl_exr_channel *channels, size_t channel_count,
                        const pl_exr_text *texts, size_t text_count, pl_bytes *out);

#endif
