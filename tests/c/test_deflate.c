/* Streams of io/deflate.h, as zlib reads them: content, memory that fails. */
#include "io/deflate.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/memory.h"
#include "files.h"

enum { SIZE = 300007 };

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

static void is_read(size_t size, pl_deflate_form form) {
  pl_bytes out = {0};
  const uint8_t before = 17; /* a stream is appended */
  assert_int_equal(pl_bytes_put(&out, 0, &before, 1), PL_OK);
  assert_int_equal(pl_deflate(data, size, form, &out), PL_OK);
  assert_int_equal(out.data[0], before);
  const pl_bytes stream = {out.data + 1, out.size - 1, 0};
  assert_int_equal(read_back(&stream, form == PL_DEFLATE_RAW ? -15 : 15), (long)size);
  assert_memory_equal(back, data, size);
  pl_bytes_clear(&out);
}

static uint32_t next(uint32_t *state) {
  *state = *state * 1664525U + 1013904223U;
  return *state >> 8;
}

/* Noise, few values, runs, a value that is rare by powers of two, repetitions far apart. */
static void zlib_reads_all(void **state) {
  static const size_t sizes[] = {0, 1, 9, 65536, SIZE};
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
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
      is_read(sizes[k], PL_DEFLATE_RAW);
      is_read(sizes[k], PL_DEFLATE_ZLIB);
    }
  }
}

static void failed_allocations_are_told(void **state) {
  (void)state;
  for (int allowed = 0;; allowed++) {
    allowance budget = {allowed};
    pl_bytes out = {0};
    pl_memory_hook(allocate_allowed, &budget);
    const pl_status status = pl_deflate(data, SIZE, PL_DEFLATE_ZLIB, &out);
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
      cmocka_unit_test(failed_allocations_are_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
