#include "io/shuffle.h"

void pl_shuffle_exr(const uint8_t *data, size_t size, uint8_t *spare, uint8_t *out) {
  const size_t pairs = size / 2, evens = size - pairs;
  for (size_t i = 0; i < pairs; i++) {
    spare[i] = data[2 * i];
    spare[evens + i] = data[2 * i + 1];
  }
  if (evens > pairs)
    spare[pairs] = data[size - 1];
  if (size > 0)
    out[0] = spare[0];
  for (size_t i = 1; i < size; i++)
    out[i] = (uint8_t)(spare[i] - spare[i - 1] + 128);
}
