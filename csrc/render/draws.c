/* One loop a dimension pair, made for the machine's vectors where it has them. */
#include "render/draws.h"

#include "base/wide.h"
#include "math/sampler.h"

PL_WIDE static void fill_pair(float *restrict first, float *restrict second,
                              const uint32_t *restrict seeds, size_t count, uint32_t index,
                              uint32_t dimension) {
  for (size_t i = 0; i < count; i++) {
    float u[2];
    pl_sample_2d(index, seeds[i], dimension, u);
    first[i] = u[0];
    second[i] = u[1];
  }
}

void pl_draws_fill(const pl_draws *draws, const uint32_t *seeds, size_t count, uint32_t index,
                   uint32_t bounce) {
  enum { PAIRS = 3 };
  fill_pair(draws->sun[0], draws->sun[1], seeds, count, index, PAIRS * bounce);
  fill_pair(draws->direction[0], draws->direction[1], seeds, count, index, PAIRS * bounce + 1);
  fill_pair(draws->choice[0], draws->choice[1], seeds, count, index, PAIRS * bounce + 2);
}
