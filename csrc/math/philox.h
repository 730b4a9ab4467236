/* Counter-based random number generator Philox4x64-10: stateless; the key identifies the quantity
 * to sample. */
#ifndef PL_MATH_PHILOX_H
#define PL_MATH_PHILOX_H

#include <stddef.h>
#include <stdint.h>

/* Salmon, Moraes, Dror, Shaw: "Parallel random numbers: as easy as 1, 2, 3" (SC 2011), 4x64 with
 * 10 rounds; the constants are those of its table 2 and of numpy.random.Philox. */
#define PL_PHILOX_M0 UINT64_C(0xD2E7470EE14C6C93)
#define PL_PHILOX_M1 UINT64_C(0xCA5A826395121157)
#define PL_PHILOX_W0 UINT64_C(0x9E3779B97F4A7C15)
#define PL_PHILOX_W1 UINT64_C(0xBB67AE8584CAA73B)
#define PL_PHILOX_ROUNDS 10

__extension__ typedef unsigned __int128 pl_uint128;

/* Four words of one (key, counter); pure. `out` may be `counter`. */
static inline void pl_philox(const uint64_t key[2], const uint64_t counter[4], uint64_t out[4]) {
  uint64_t c0 = counter[0], c1 = counter[1], c2 = counter[2], c3 = counter[3];
  uint64_t k0 = key[0], k1 = key[1];
  for (int round = 0; round < PL_PHILOX_ROUNDS; round++) {
    const pl_uint128 p0 = (pl_uint128)PL_PHILOX_M0 * c0;
    const pl_uint128 p1 = (pl_uint128)PL_PHILOX_M1 * c2;
    c0 = (uint64_t)(p1 >> 64) ^ c1 ^ k0;
    c1 = (uint64_t)p1;
    c2 = (uint64_t)(p0 >> 64) ^ c3 ^ k1;
    c3 = (uint64_t)p0;
    k0 += PL_PHILOX_W0;
    k1 += PL_PHILOX_W1;
  }
  out[0] = c0;
  out[1] = c1;
  out[2] = c2;
  out[3] = c3;
}

/* A word as a number in [0, 1) by its top 53 bits, as numpy.random.Generator.random has it. */
static inline double pl_philox_double(uint64_t word) { return (double)(word >> 11) * 0x1p-53; }

/* Numbers of one key, one after the other. Starts as {.key = {...}}. */
typedef struct pl_philox_stream {
  uint64_t key[2], words[4], used;
} pl_philox_stream;

static inline double pl_philox_next(pl_philox_stream *s) {
  if (s->used % 4 == 0) {
    const uint64_t counter[4] = {s->used / 4, 0, 0, 0};
    pl_philox(s->key, counter, s->words);
  }
  return pl_philox_double(s->words[s->used++ % 4]);
}

/* `count` words in the order of numpy.random.Philox(key=key, counter=counter).random_raw(count):
 * the 256-bit counter (least significant word first) is incremented before each block of four. */
void pl_philox_fill(const uint64_t key[2], const uint64_t counter[4], size_t count, uint64_t *out);

#endif
