#include "io/deflate.h"

#include <stdbool.h>
#include <string.h>
#include <zlib.h>

#include "base/memory.h"
#include "io/huffman.h"

/* Bytes of a block, which has codes of its own; of the shortest run that is looked for, and of the
 * longest that a symbol tells. */
enum { BLOCK = 1 << 17, WORD = 8, LONGEST = 258, SHORTEST = 3 };
/* Words are found again by so many bits. */
enum { HASH_BITS = 12 };
/* Longest code: four of them fit into 64 bits beside the rest of a byte. */
enum { LIMIT = 12 };
/* Symbols: of bytes, of the end of a block, and of lengths of runs. */
enum { END = 256, LENGTHS = 29, SYMBOLS = END + 1 + LENGTHS, DISTANCES = 30 };
/* Bytes of a stored piece, and of what begins it. */
enum { PIECE = 65535, PIECE_HEAD = 6 };
/* Bits of a length in a block's header; their own codes have that many each. */
enum { LENGTH_BITS = 4, LENGTH_CODES = 19 };
/* A block is stored unless its codes win a part of it. */
static const double WORTH = 0.97;

/* RFC 1951, 3.2.5. */
static const uint16_t length_base[LENGTHS] = {3,  4,  5,  6,   7,   8,   9,   10,  11, 13,
                                              15, 17, 19, 23,  27,  31,  35,  43,  51, 59,
                                              67, 83, 99, 115, 131, 163, 195, 227, 258};
static const uint8_t length_extra[LENGTHS] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                                              2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};

/* Bytes as they are, then a run of bytes that are those at a distance before. */
typedef struct step {
  uint32_t bytes, run, distance;
} step;

typedef struct encoder {
  const uint8_t *data;
  size_t stride;
  uint64_t bits; /* not yet a byte */
  int bit_count;
  size_t step_count, used; /* of scratch */
  uint32_t counts[SYMBOLS], distance_counts[DISTANCES];
  pl_huffman codes, distance_codes;
  size_t places[1 << HASH_BITS]; /* where words were met, + 1 */
  uint8_t length_symbol[LONGEST + 1];
  step steps[BLOCK / WORD + 2];
  uint8_t scratch[BLOCK + (BLOCK / PIECE + 2) * PIECE_HEAD + 4 * WORD];
} encoder;

/* --- bits ------------------------------------------------------------------------------------- */

/* Brings whole bytes to the scratch; there is room for a word. */
static void flush_bytes(encoder *e) {
  for (int k = 0; k < WORD; k++)
    e->scratch[e->used + (size_t)k] = (uint8_t)(e->bits >> (8 * k));
  const int bytes = e->bit_count / 8;
  e->used += (size_t)bytes;
  e->bits >>= 8 * bytes;
  e->bit_count -= 8 * bytes;
}

/* At most 56 bits come between flushes. */
static void add(encoder *e, uint64_t value, int count) {
  e->bits |= value << e->bit_count;
  e->bit_count += count;
}

static void put(encoder *e, uint64_t value, int count) {
  add(e, value, count);
  flush_bytes(e);
}

static void put_to_byte(encoder *e) { put(e, 0, (8 - e->bit_count % 8) % 8); }

/* --- runs ------------------------------------------------------------------------------------- */

static uint64_t word_at(const uint8_t *at) {
  uint64_t out = 0;
  for (int k = 0; k < WORD; k++)
    out |= (uint64_t)at[k] << (8 * k);
  return out;
}

/* Bytes from `at` on that are those at a distance before, up to `end`. */
static size_t run_at(const encoder *e, size_t at, size_t end, size_t distance) {
  const size_t start = at;
  const uint8_t *d = e->data;
  while (at + WORD <= end && word_at(d + at) == word_at(d + at - distance))
    at += WORD;
  while (at < end && d[at] == d[at - distance])
    at++;
  return at - start;
}

/* How far before `at` its word was met, which is noted; 0: nowhere near. */
static size_t met_before(encoder *e, size_t at) {
  const uint64_t word = word_at(e->data + at);
  size_t *place = &e->places[word * 0x9e3779b97f4a7c15U >> (64 - HASH_BITS)];
  const size_t before = *place, distance = at + 1 - before;
  *place = at + 1;
  const bool near = before > 0 && distance <= PL_DEFLATE_MAX_STRIDE;
  return near && word_at(e->data + at - distance) == word ? distance : 0;
}

/* Divides a block into steps. A word in which a byte differs from the stride before cannot begin
 * such a run before its last one that does. */
static void find_steps(encoder *e, size_t start, size_t end) {
  size_t from = start, at = start < e->stride ? e->stride : start;
  e->step_count = 0;
  while (at + WORD <= end) {
    const uint64_t differs = word_at(e->data + at) ^ word_at(e->data + at - e->stride);
    const size_t distance = differs == 0 ? e->stride : met_before(e, at);
    if (distance == 0) {
      at += (size_t)(WORD - __builtin_clzll(differs) / 8);
      continue;
    }
    const size_t run = run_at(e, at, end, distance);
    e->steps[e->step_count++] = (step){(uint32_t)(at - from), (uint32_t)run, (uint32_t)distance};
    from = at += run;
  }
  e->steps[e->step_count++] = (step){(uint32_t)(end - from), 0, 0};
}

/* Symbol of a distance, how many bits follow it, and which. */
static int distance_symbol(uint32_t distance, int *extra, uint32_t *rest) {
  const uint32_t d = distance - 1;
  if (d < 4) {
    *extra = 0;
    *rest = 0;
    return (int)d;
  }
  const int top = 31 - __builtin_clz(d);
  *extra = top - 1;
  *rest = d & ((1U << *extra) - 1);
  return 2 * top + (int)(d >> (top - 1) & 1U);
}

/* The next piece of a run: none is too short for a symbol. */
static uint32_t piece_of(uint32_t run) {
  if (run <= LONGEST)
    return run;
  return run - LONGEST >= SHORTEST ? LONGEST : LONGEST - SHORTEST;
}

static void count_bytes(encoder *e, const uint8_t *at, uint32_t count) {
  uint32_t *c = e->counts;
  for (uint32_t i = 0; i < count; i++)
    c[at[i]]++;
}

/* Counts symbols; returns the bits that follow those of runs. */
static uint64_t count_symbols(encoder *e, size_t start) {
  uint64_t more = 0;
  uint32_t unused;
  int extra = 0;
  memset(e->counts, 0, sizeof e->counts);
  memset(e->distance_counts, 0, sizeof e->distance_counts);
  for (size_t i = 0; i < e->step_count; i++) {
    const step *s = &e->steps[i];
    const int far = s->run > 0 ? distance_symbol(s->distance, &extra, &unused) : 0;
    count_bytes(e, e->data + start, s->bytes);
    for (uint32_t rest = s->run; rest > 0;) {
      const uint32_t piece = piece_of(rest);
      const int symbol = e->length_symbol[piece];
      e->counts[END + 1 + symbol]++;
      e->distance_counts[far]++;
      more += (uint64_t)(length_extra[symbol] + extra);
      rest -= piece;
    }
    start += s->bytes + s->run;
  }
  e->counts[END] = 1;
  return more;
}

/* --- blocks ----------------------------------------------------------------------------------- */

static void store(encoder *e, size_t start, size_t end, bool last) {
  do {
    const size_t size = end - start < PIECE ? end - start : PIECE;
    put(e, last && start + size == end, 3);
    put_to_byte(e);
    put(e, size, 16);
    put(e, size ^ 0xffffU, 16);
    if (size > 0)
      memcpy(e->scratch + e->used, e->data + start, size);
    e->used += size;
    start += size;
  } while (start < end);
}

static void put_header(encoder *e, bool last) {
  put(e, (uint64_t)last | 2U << 1, 3);
  put(e, SYMBOLS - 257, 5);
  put(e, DISTANCES - 1, 5);
  put(e, LENGTH_CODES - 4, 4);
  for (int k = 0; k < LENGTH_CODES; k++) /* the first three are of repetitions, which none has */
    put(e, k < 3 ? 0 : LENGTH_BITS, 3);
  for (int s = 0; s < SYMBOLS + DISTANCES; s++) {
    const uint32_t bits =
        s < SYMBOLS ? e->codes.lengths[s] : e->distance_codes.lengths[s - SYMBOLS];
    uint64_t code = 0; /* those of 4 bits are the lengths themselves, first bit lowest */
    for (int k = 0; k < LENGTH_BITS; k++)
      code |= (uint64_t)(bits >> k & 1U) << (LENGTH_BITS - 1 - k);
    put(e, code, LENGTH_BITS);
  }
}

static void put_bytes(encoder *e, const uint8_t *at, uint32_t count) {
  const pl_huffman *h = &e->codes;
  uint32_t i = 0;
  for (; i + 4 <= count; i += 4) {
    for (int k = 0; k < 4; k++)
      add(e, h->codes[at[i + (uint32_t)k]], h->lengths[at[i + (uint32_t)k]]);
    flush_bytes(e);
  }
  for (; i < count; i++)
    put(e, h->codes[at[i]], h->lengths[at[i]]);
}

static void put_run(encoder *e, const step *s) {
  int extra;
  uint32_t rest;
  if (s->run == 0)
    return;
  const int far = distance_symbol(s->distance, &extra, &rest);
  for (uint32_t left = s->run, piece; left > 0; left -= piece) {
    piece = piece_of(left);
    const int symbol = e->length_symbol[piece];
    add(e, e->codes.codes[END + 1 + symbol], e->codes.lengths[END + 1 + symbol]);
    add(e, piece - length_base[symbol], length_extra[symbol]);
    add(e, e->distance_codes.codes[far], e->distance_codes.lengths[far]);
    put(e, rest, extra);
  }
}

/* Finds the codes of what is counted; returns their bits. */
static uint64_t find_codes(const uint32_t *counts, size_t count, pl_huffman *out) {
  uint64_t bits = 0;
  pl_huffman_build(counts, count, LIMIT, out);
  for (size_t s = 0; s < count; s++)
    bits += (uint64_t)counts[s] * out->lengths[s];
  return bits;
}

static void put_block(encoder *e, size_t start, size_t end, bool last) {
  const size_t first = start;
  find_steps(e, start, end);
  uint64_t bits = count_symbols(e, start) + (uint64_t)(SYMBOLS + DISTANCES) * LENGTH_BITS + 74;
  bits += find_codes(e->counts, SYMBOLS, &e->codes);
  bits += find_codes(e->distance_counts, DISTANCES, &e->distance_codes);
  if ((double)bits > 8.0 * WORTH * (double)(end - start)) {
    store(e, first, end, last);
    return;
  }
  put_header(e, last);
  for (size_t i = 0; i < e->step_count; i++) {
    put_bytes(e, e->data + start, e->steps[i].bytes);
    put_run(e, &e->steps[i]);
    start += e->steps[i].bytes + e->steps[i].run;
  }
  put(e, e->codes.codes[END], e->codes.lengths[END]);
}

/* --- streams ---------------------------------------------------------------------------------- */

static void set_up(encoder *e, const void *data, size_t stride) {
  e->data = data;
  e->stride = stride;
  int symbol = 0;
  for (uint32_t length = SHORTEST; length <= LONGEST; length++) {
    symbol += symbol + 1 < LENGTHS && length_base[symbol + 1] <= length;
    e->length_symbol[length] = (uint8_t)symbol;
  }
}

pl_status pl_deflate(const void *data, size_t size, size_t stride, pl_bytes *out) {
  void *memory;
  if (stride < 1 || stride > PL_DEFLATE_MAX_STRIDE)
    return pl_fail(PL_E_RANGE, "deflate: a stride of %zu; must be in 1..%d", stride,
                   PL_DEFLATE_MAX_STRIDE);
  PL_TRY(pl_alloc_or_fail(1, sizeof(encoder), "a compressed array", &memory));
  encoder *e = memory;
  pl_status status = PL_OK;
  set_up(e, data, stride);
  size_t start = 0;
  do {
    const size_t end = size - start < BLOCK ? size : start + BLOCK;
    e->used = 0;
    put_block(e, start, end, end == size);
    if (end == size)
      put_to_byte(e);
    status = pl_bytes_put(out, out->size, e->scratch, e->used);
    start = end;
  } while (status == PL_OK && start < size);
  pl_free(e);
  return status;
}

pl_status pl_deflate_zlib(const void *data, size_t size, size_t stride, pl_bytes *out) {
  static const uint8_t head[] = {0x78, 0x01}; /* deflate with a window of 32 KiB, made fast */
  PL_TRY(pl_bytes_put(out, out->size, head, sizeof head));
  PL_TRY(pl_deflate(data, size, stride, out));
  const uint32_t sum = (uint32_t)adler32_z(adler32_z(0, NULL, 0), data, size);
  const uint8_t tail[] = {(uint8_t)(sum >> 24), (uint8_t)(sum >> 16), (uint8_t)(sum >> 8),
                          (uint8_t)sum};
  return pl_bytes_put(out, out->size, tail, sizeof tail);
}
