/* Sequences of Philox words in the order of NumPy. */
#include "math/philox.h"

void pl_philox_fill(const uint64_t key[2], const uint64_t counter[4], size_t count, uint64_t *out) {
  uint64_t next[4] = {counter[0], counter[1], counter[2], counter[3]};
  for (size_t done = 0; done < count; done += 4) {
    for (int i = 0; i < 4 && ++next[i] == 0; i++) {
    } /* carry */
    uint64_t block[4];
    pl_philox(key, next, block);
    for (size_t i = 0; i < 4 && done + i < count; i++)
      out[done + i] = block[i];
  }
}
