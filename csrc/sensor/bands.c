/* Applies a small matrix to every pixel. */
#include "sensor/bands.h"

void pl_bands_write(const float parts[][3], int bands, const pl_vec3f *radiance, size_t count,
                    float *out) {
  for (size_t i = 0; i < count; i++)
    for (int b = 0; b < bands; b++)
      *out++ =
          parts[b][0] * radiance[i].x + parts[b][1] * radiance[i].y + parts[b][2] * radiance[i].z;
}
