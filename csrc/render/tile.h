/* Tiles of the image: square blocks of pixels, each of which one worker renders. */
#ifndef PL_RENDER_TILE_H
#define PL_RENDER_TILE_H

#include <stdbool.h>
#include <stdint.h>

enum { PL_TILE_SIDE = 32, PL_TILE_PIXELS = PL_TILE_SIDE * PL_TILE_SIDE };

typedef struct pl_tile {
  int x0, y0, width, height; /* pixels */
} pl_tile;

/* Compacts the bits of `i` at even positions. */
static inline uint32_t pl_even_bits(uint32_t i) {
  i &= UINT32_C(0x55555555);
  i = (i | i >> 1) & UINT32_C(0x33333333);
  i = (i | i >> 2) & UINT32_C(0x0f0f0f0f);
  return (i | i >> 4) & UINT32_C(0x00ff00ff);
}

/* Pixel `nth` of a full tile along the Z-order curve (Morton 1966): the rays of a packet come from
 * one or two squares, and stay coherent. */
static inline uint32_t pl_tile_pixel(uint32_t nth) {
  return pl_even_bits(nth >> 1) * PL_TILE_SIDE + pl_even_bits(nth);
}

/* Whether the pixel lies in a tile, which may be cut off at the image's edge. */
static inline bool pl_tile_has(pl_tile tile, uint32_t pixel) {
  return (int)(pixel % PL_TILE_SIDE) < tile.width && (int)(pixel / PL_TILE_SIDE) < tile.height;
}

#endif
