/* One loop per dimension pair, vectorised where the machine supports it. */
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
  if (draws->direction[0] != NULL)
    fill_pair(draws->direction[0], draws->direction[1], seeds, count, index, PAIRS * bounce + 1);
  fill_pair(draws->choice[0], draws->choice[1], seeds, count, index, PAIRS * bounce + 2);
}

/* Spreads the low 8 bits of x to the even bit positions. */
static inline uint32_t part_bits(uint32_t x) {
  x = (x | (x << 4)) & 0x0f0fu;
  x = (x | (x << 2)) & 0x3333u;
  return (x | (x << 1)) & 0x5555u;
}

static inline float flip_bits(float u, float by) {
  return (float)((uint32_t)(u * 0x1p24f) ^ (uint32_t)(by * 0x1p24f)) * 0x1p-24f;
}

/* All pixels use the same sequence. Each pixel XORs it bitwise with its point of a second sequence,
 * taken in Morton order (1966). A digital net over samples, and over pixels, remains a net after an
 * XOR of all its points with one value. */
PL_WIDE static void flip_pair(float *restrict first, float *restrict second,
                              const uint32_t *restrict pixels, size_t count, uint32_t row_bits,
                              uint32_t seed, const float base[2]) {
  const uint32_t flips = 0x5eedu; /* not used as a dimension elsewhere */
  for (size_t i = 0; i < count; i++) {
    const uint32_t x = pixels[i] & ((1u << row_bits) - 1u), y = pixels[i] >> row_bits;
    float by[2];
    pl_sample_2d(part_bits(x) | part_bits(y) << 1, seed, flips, by);
    first[i] = flip_bits(base[0], by[0]);
    second[i] = flip_bits(base[1], by[1]);
  }
}

void pl_draws_spread(float *const direction[2], const uint32_t *pixels, size_t count,
                     uint32_t row_bits, uint32_t tile_seed, uint32_t index) {
  float base[2];
  pl_sample_2d(index, tile_seed, 1, base);
  flip_pair(direction[0], direction[1], pixels, count, row_bits, tile_seed, base);
}
