/* Stable 64-bit hash (FNV-1a): the value is the same on every machine and in every version. */
#ifndef PL_BASE_HASH_H
#define PL_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

#define PL_HASH_SEED 0xcbf29ce484222325u

/* Returns the hash of `size` bytes, continued from `seed` (PL_HASH_SEED for a new hash). */
uint64_t pl_hash(uint64_t seed, const void *bytes, size_t size);

#endif
