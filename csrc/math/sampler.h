/* Low-discrepancy 2-D samples keyed by (pixel seed, sample index, dimension pair); stateless.
 *
 * Each dimension pair is the Sobol (0,2)-sequence with shuffled index and Owen-scrambled
 * coordinates, both by hashes, so that dimension pairs and pixels are independent: Burley,
 * "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020. The scrambling hash is that of Vegdahl,
 * "Building a Better LK Hash" (2021), which has less bias than the paper's. Any aligned run of 2^k
 * indices is a (0,k,2)-net: one sample in every elementary interval. */
#ifndef PL_MATH_SAMPLER_H
#define PL_MATH_SAMPLER_H

#include <stdint.h>

/* Permutation of 32-bit numbers with good avalanche (Wellons, hash-prospector, "lowbias32"). */
static inline uint32_t pl_sampler_mix(uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return x;
}

static inline uint32_t pl_sampler_reverse_bits(uint32_t x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
  return (x >> 16) | (x << 16);
}

/* A permutation in which a bit depends only on itself and the bits below it: an Owen scramble of
 * the bit-reversed number. */
static inline uint32_t pl_sampler_owen_reversed(uint32_t x, uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

/* The second Sobol coordinate of `index`, bit-reversed. Its generator matrix is Pascal's triangle
 * mod 2, the fifth Kronecker power of (1 1; 0 1), hence five masked shifts instead of 32 steps. */
static inline uint32_t pl_sampler_pascal(uint32_t index) {
  index ^= (index >> 1) & 0x55555555u;
  index ^= (index >> 2) & 0x33333333u;
  index ^= (index >> 4) & 0x0f0f0f0fu;
  index ^= (index >> 8) & 0x00ff00ffu;
  index ^= (index >> 16) & 0x0000ffffu;
  return index;
}

/* Sample `index` of dimension pair `dimension` of the pixel whose seed is `seed`; both in [0, 1).
 */
static inline void pl_sample_2d(uint32_t index, uint32_t seed, uint32_t dimension, float out[2]) {
  const uint32_t key = pl_sampler_mix(seed ^ pl_sampler_mix(dimension + 0x9e3779b9u));
  const uint32_t shuffled =
      pl_sampler_reverse_bits(pl_sampler_owen_reversed(pl_sampler_reverse_bits(index), key));
  const uint32_t key_x = pl_sampler_mix(key ^ 0xa511e9b3u);
  const uint32_t key_y = pl_sampler_mix(key ^ 0x63d83595u);
  const uint32_t x = pl_sampler_reverse_bits(pl_sampler_owen_reversed(shuffled, key_x));
  const uint32_t y =
      pl_sampler_reverse_bits(pl_sampler_owen_reversed(pl_sampler_pascal(shuffled), key_y));
  out[0] = (float)(x >> 8) * 0x1p-24f;
  out[1] = (float)(y >> 8) * 0x1p-24f;
}

#endif
