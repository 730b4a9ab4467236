/* Cells of the canvas in which an entity may be, from the boxes of its triangles. */
#ifndef PL_ANNOTATE_OUTLINE_CELLS_H
#define PL_ANNOTATE_OUTLINE_CELLS_H

#include <stdint.h>

#include "annotate/object_label.h"
#include "annotate/outline.h"

/* Sides of a tile, the work of a thread at a time, and of a cell, of which rays are cast for all or
 * for none, pixels. */
enum {
  PL_OUTLINE_TILE = 32,
  PL_OUTLINE_CELL = 8,
  PL_OUTLINE_TILE_PIXELS = PL_OUTLINE_TILE * PL_OUTLINE_TILE
};

/* The box of an entity, in tiles from its corner on. */
typedef struct pl_outline_cells {
  pl_rect box;       /* the outline's rectangle, and the visible pixels */
  int columns, rows; /* of tiles */
  size_t stride;     /* cells of a row, counted in whole tiles */
  uint8_t *cells;    /* 1 where the entity may be; borrowed */
} pl_outline_cells;

/* A tile of the box: its pixels, and its first cell. */
typedef struct pl_outline_tile {
  int x0, y0, width, height;
  const uint8_t *cells;
  bool outside; /* of the image: none of its pixels is there */
} pl_outline_tile;

/* Returns the number of bytes of scratch memory for the cells of a canvas. */
size_t pl_outline_cells_size(const pl_camera *camera);

/* Marks the cells of an entity whose visible pixels have an extent; not for one that is nowhere.
 * `memory` has the size of pl_outline_cells_size. */
pl_outline_cells pl_outline_cells_mark(const pl_outline *outline, const pl_camera *camera,
                                       const pl_extent *extent, uint8_t *memory);

/* Tile `item` of columns x rows. */
pl_outline_tile pl_outline_cells_tile(const pl_outline_cells *cells, const pl_camera *camera,
                                      size_t item);

/* Calls `look` for the pixels of a tile that are in the image, and outside for those in marked
 * cells, with whether the entity may be there: in blocks of 4 x 2, so that a packet of eight rays
 * is coherent. Pixels are relative to the tile's corner. */
typedef void (*pl_outline_look)(void *context, int x, int y, bool possible);
void pl_outline_tile_visit(const pl_outline_tile *tile, size_t stride, pl_outline_look look,
                           void *context);

/* Whether an entity is nowhere on the canvas. */
static inline bool pl_outline_is_nowhere(const pl_outline *outline, const pl_extent *extent) {
  return extent->count == 0 && outline->rect.x0 > outline->rect.x1;
}

#endif
