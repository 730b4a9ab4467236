#include "io/shuffle.h"

#include <string.h>

/* With a known `item` compilers make it a copy of vectors. */
static inline void take_apart(const uint8_t *data, size_t count, size_t item, uint8_t *out) {
  for (size_t k = 0; k < item; k++)
    for (size_t i = 0; i < count; i++)
      out[k * count + i] = data[i * item + k];
}

void pl_shuffle_items(const uint8_t *data, size_t size, size_t item, uint8_t *out) {
  const size_t count = size / item;
  switch (item) {
  case 1:
    if (size > 0)
      memcpy(out, data, size);
    break;
  case 2:
    take_apart(data, count, 2, out);
    break;
  case 4:
    take_apart(data, count, 4, out);
    break;
  case 8:
    take_apart(data, count, 8, out);
    break;
  default:
    take_apart(data, count, item, out);
  }
}

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
