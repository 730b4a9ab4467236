/* FNV-1a hash, 64 bits (Fowler, Noll, Vo), with the parameters of RFC 9923. */
#include "base/hash.h"

uint64_t pl_hash(uint64_t seed, const void *bytes, size_t size) {
  const unsigned char *byte = bytes;
  uint64_t hash = seed;
  for (size_t i = 0; i < size; i++) {
    hash ^= byte[i];
    hash *= 0x100000001b3u;
  }
  return hash;
}
