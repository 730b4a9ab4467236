/* Memory management of images. */
#include "geom/image.h"

#include "base/memory.h"

enum { MAX_SIDE = 65536 };

pl_status pl_image_init(int width, int height, int channels, pl_image *out) {
  *out = (pl_image){0};
  if (width < 1 || height < 1 || width > MAX_SIDE || height > MAX_SIDE)
    return pl_fail(PL_E_RANGE, "image of %d x %d texels: sides must be in 1..%d", width, height,
                   MAX_SIDE);
  if (channels < 1 || channels > 4)
    return pl_fail(PL_E_RANGE, "image with %d channels: must be 1..4", channels);
  void *texels;
  PL_TRY(pl_alloc_or_fail((size_t)width * (size_t)height, (size_t)channels, "an image", &texels));
  *out = (pl_image){width, height, channels, texels};
  return PL_OK;
}

void pl_image_clear(pl_image *image) {
  pl_free(image->texels);
  *image = (pl_image){0};
}
