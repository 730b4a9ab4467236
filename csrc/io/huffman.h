/* Huffman codes of limited length, as deflate has them (RFC 1951, 3.2.2). */
#ifndef PL_IO_HUFFMAN_H
#define PL_IO_HUFFMAN_H

#include <stddef.h>
#include <stdint.h>

enum { PL_HUFFMAN_MOST_SYMBOLS = 288 };

typedef struct pl_huffman {
  uint8_t lengths[PL_HUFFMAN_MOST_SYMBOLS]; /* bits; 0: the symbol does not occur */
  uint16_t codes[PL_HUFFMAN_MOST_SYMBOLS];  /* first bit lowest, as they are written */
} pl_huffman;

/* Finds the codes of the first `count` symbols from how often they occur, of at most `limit` bits,
 * for which 2^limit >= count. Sums of counts stay below 2^32. */
void pl_huffman_build(const uint32_t *counts, size_t count, int limit, pl_huffman *out);

#endif
