#include "io/huffman.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_BITS = 32 };

typedef struct leaf {
  uint32_t count;
  uint16_t symbol;
} leaf;

static int by_count(const void *a, const void *b) {
  const leaf *x = a, *y = b;
  if (x->count != y->count)
    return x->count < y->count ? -1 : 1;
  return (int)x->symbol - (int)y->symbol;
}

/* Turns counts in ascending order into the depths of leaves, in descending order (Moffat and
 * Katajainen 1995, "In-place calculation of minimum-redundancy codes"). */
static void depths_of(uint32_t *a, int n) {
  int root = 0, leaf = 2;
  a[0] += a[1];
  for (int next = 1; next < n - 1; next++) { /* inner nodes: their sums, then their parents */
    for (int child = 0; child < 2; child++) {
      const bool inner = leaf >= n || (root < next && a[root] < a[leaf]);
      const uint32_t sum = inner ? a[root] : a[leaf];
      a[next] = child == 0 ? sum : a[next] + sum;
      if (inner)
        a[root++] = (uint32_t)next;
      else
        leaf++;
    }
  }
  a[n - 2] = 0;
  for (int k = n - 3; k >= 0; k--)
    a[k] = a[a[k]] + 1;
  int open = 1, used = 0, next = n - 1;
  uint32_t depth = 0;
  for (root = n - 2; open > 0; depth++, open = 2 * used, used = 0) {
    for (; root >= 0 && a[root] == depth; root--)
      used++;
    for (; open > used; open--)
      a[next--] = depth;
  }
}

/* Moves codes above the limit up, and others down until the code is complete again. */
static void limit_lengths(int of_length[MOST_BITS + 1], int limit) {
  uint32_t total = 0;
  for (int k = limit + 1; k <= MOST_BITS; k++) {
    of_length[limit] += of_length[k];
    of_length[k] = 0;
  }
  for (int k = limit; k > 0; k--)
    total += (uint32_t)of_length[k] << (limit - k);
  for (; total > 1U << limit; total--) {
    int k = limit - 1;
    while (of_length[k] == 0)
      k--;
    of_length[limit]--;
    of_length[k]--;
    of_length[k + 1] += 2;
  }
}

static uint16_t reversed(uint32_t code, int bits) {
  uint32_t out = 0;
  for (int k = 0; k < bits; k++)
    out |= (code >> k & 1U) << (bits - 1 - k);
  return (uint16_t)out;
}

/* Canonical codes: by length, then by symbol. */
static void assign(size_t count, int limit, pl_huffman *out) {
  uint32_t code = 0;
  for (int bits = 1; bits <= limit; bits++, code <<= 1)
    for (size_t s = 0; s < count; s++)
      if (out->lengths[s] == bits)
        out->codes[s] = reversed(code++, bits);
}

void pl_huffman_build(const uint32_t *counts, size_t count, int limit, pl_huffman *out) {
  leaf leaves[PL_HUFFMAN_MOST_SYMBOLS];
  uint32_t depths[PL_HUFFMAN_MOST_SYMBOLS];
  int of_length[MOST_BITS + 1] = {0}, n = 0;
  memset(out, 0, sizeof *out);
  for (size_t s = 0; s < count; s++)
    if (counts[s] > 0)
      leaves[n++] = (leaf){counts[s], (uint16_t)s};
  qsort(leaves, (size_t)n, sizeof *leaves, by_count);
  for (int i = 0; i < n; i++)
    depths[i] = leaves[i].count;
  if (n > 1)
    depths_of(depths, n);
  else if (n == 1)
    depths[0] = 1;
  for (int i = 0; i < n; i++)
    of_length[depths[i] < MOST_BITS ? depths[i] : MOST_BITS]++;
  limit_lengths(of_length, limit);
  for (int bits = 1, i = n; bits <= limit; bits++)
    for (int k = 0; k < of_length[bits]; k++)
      out->lengths[leaves[--i].symbol] = (uint8_t)bits;
  assign(count, limit, out);
}
