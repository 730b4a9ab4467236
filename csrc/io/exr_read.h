/* Reads OpenEXR files as io/exr.h writes them: one part of scan lines, in memory. */
#ifndef PL_IO_EXR_READ_H
#define PL_IO_EXR_READ_H

#include <stddef.h>

#include "base/status.h"
#include "io/exr.h"

typedef struct pl_exr_plane {
  char name[256];
  pl_exr_type type;
  void *samples; /* row by row, without gaps; 4 bytes, or 2 for PL_EXR_HALF */
} pl_exr_plane;

typedef struct pl_exr_image {
  int width, height;
  size_t count;
  pl_exr_plane *planes; /* by name, as the file has them */
} pl_exr_image;

/* Decodes the first part of a file. `name` stands in errors. `out` is empty after an error, else
 * the caller's to clear. Reentrant. PL_E_FORMAT for a damaged file, for tiles, deep or subsampled
 * channels, and for pixels that start elsewhere than at 0, 0; PL_E_MEMORY. */
pl_status pl_exr_decode(const void *data, size_t size, const char *name, pl_exr_image *out);

void pl_exr_image_clear(pl_exr_image *image);

#endif
