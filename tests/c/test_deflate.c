/* Streams of io/deflate.h, as zlib reads them: content, sizes, refusals, memory that fails. */
#include "io/deflate.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/memory.h"
#include "files.h"
#include "io/shuffle.h"

enum { SIZE = 300007 }; /* three blocks, the last one short */

static uint8_t data[SIZE], back[SIZE + 1];

/* What zlib makes of a stream; -1 for an error. `bits`: its windowBits. */
static long read_back(const pl_bytes *from, int bits) {
  z_stream z = {.next_in = from->data,
                .avail_in = (uInt)from->size,
                .next_out = back,
                .avail_out = sizeof back};
  if (inflateInit2(&z, bits) != Z_OK)
    return -1;
  const int code = inflate(&z, Z_FINISH);
  const long size = code == Z_STREAM_END && z.avail_in == 0 ? (long)z.total_out : -1;
  inflateEnd(&z);
  return size;
}

static void is_read(size_t size, size_t stride) {
  pl_bytes raw = {0}, whole = {0};
  assert_int_equal(pl_deflate(data, size, stride, &raw), PL_OK);
  assert_int_equal(read_back(&raw, -15), (long)size);
  assert_memory_equal(back, data, size);
  assert_int_equal(pl_deflate_zlib(data, size, stride, &whole), PL_OK);
  assert_int_equal(read_back(&whole, 15), (long)size);
  assert_memory_equal(back, data, size);
  pl_bytes_clear(&raw);
  pl_bytes_clear(&whole);
}

static uint32_t next(uint32_t *state) {
  *state = *state * 1664525U + 1013904223U;
  return *state >> 8;
}

/* Noise, few values, runs, a value that is rare by powers of two (the longest codes), repetitions
 * far apart: at sizes beside those of blocks and words. */
static void zlib_reads_all(void **state) {
  static const size_t sizes[] = {0, 1, 7, 8, 9, 65536, 131071, 131072, 131073, SIZE};
  static const size_t strides[] = {1, 2, 3, 12, PL_DEFLATE_MAX_STRIDE};
  uint32_t seed = 1;
  (void)state;
  for (int kind = 0; kind < 5; kind++) {
    for (size_t i = 0; i < SIZE; i++) {
      const uint32_t r = next(&seed);
      const uint8_t rare = (uint8_t)(r == 0 ? 24 : __builtin_ctz(r));
      const uint8_t kinds[] = {(uint8_t)r, r & 1, (uint8_t)(i / 700), rare,
                               i < 9001 ? (uint8_t)r : data[i - 9001]};
      data[i] = kinds[kind];
    }
    for (size_t a = 0; a < sizeof sizes / sizeof *sizes; a++)
      for (size_t b = 0; b < sizeof strides / sizeof *strides; b++)
        is_read(sizes[a], strides[b]);
  }
}

static size_t size_of(size_t size, size_t stride) {
  pl_bytes out = {0};
  assert_int_equal(pl_deflate(data, size, stride, &out), PL_OK);
  const size_t found = out.size;
  pl_bytes_clear(&out);
  return found;
}

static void it_compresses(void **state) {
  uint32_t seed = 7;
  (void)state;
  for (size_t i = 0; i < SIZE; i++)
    data[i] = (uint8_t)next(&seed);
  assert_in_range(size_of(SIZE, 4), SIZE, SIZE + 64); /* noise is stored */
  for (size_t i = 4096; i < SIZE; i++)
    data[i] = data[i - 4096]; /* what was met before is found */
  assert_in_range(size_of(SIZE, 4), 4096, SIZE / 5);
  for (size_t i = 12; i < SIZE; i++)
    data[i] = data[i - 12];
  assert_in_range(size_of(SIZE, 12), 100, 2000);
  for (size_t i = 0; i < SIZE; i++)
    data[i] =
        (uint8_t)(next(&seed) >> 16 & 3); /* two bits each, three of some: there is the end, too */
  assert_in_range(size_of(SIZE, 1), SIZE / 4, 2 * SIZE / 7);
}

static void strides_are_refused(void **state) {
  pl_bytes out = {0};
  (void)state;
  assert_int_equal(pl_deflate(data, 9, 0, &out), PL_E_RANGE);
  assert_int_equal(pl_deflate(data, 9, PL_DEFLATE_MAX_STRIDE + 1, &out), PL_E_RANGE);
  pl_bytes_clear(&out);
}

static void items_are_taken_apart(void **state) {
  static const uint8_t from[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  static const uint8_t by_four[] = {1, 5, 9, 2, 6, 10, 3, 7, 11, 4, 8, 12};
  static const uint8_t by_three[] = {1, 4, 7, 10, 2, 5, 8, 11, 3, 6, 9, 12};
  uint8_t out[sizeof from];
  (void)state;
  pl_shuffle_items(from, sizeof from, 4, out);
  assert_memory_equal(out, by_four, sizeof out);
  pl_shuffle_items(from, sizeof from, 3, out);
  assert_memory_equal(out, by_three, sizeof out);
}

static void failed_allocations_are_told(void **state) {
  (void)state;
  for (int allowed = 0;; allowed++) {
    allowance budget = {allowed};
    pl_bytes out = {0};
    pl_memory_hook(allocate_allowed, &budget);
    const pl_status status = pl_deflate_zlib(data, SIZE, 4, &out);
    pl_memory_hook(NULL, NULL);
    pl_bytes_clear(&out);
    if (status == PL_OK)
      return;
    assert_int_equal(status, PL_E_MEMORY);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(zlib_reads_all),
      cmocka_unit_test(it_compresses),
      cmocka_unit_test(strides_are_refused),
      cmocka_unit_test(items_are_taken_apart),
      cmocka_unit_test(failed_allocations_are_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
