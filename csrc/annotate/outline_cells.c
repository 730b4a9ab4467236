/* Marks cells by projecting boxes of triangles. */
#include "annotate/outline_cells.h"

#include <string.h>

enum { TILE = PL_OUTLINE_TILE, CELL = PL_OUTLINE_CELL, TILE_CELLS = TILE / CELL };

/* The tiles of the canvas and one more along each axis, as a box need not begin at a tile
 * boundary. */
size_t pl_outline_cells_size(const pl_camera *camera) {
  const size_t columns = (3 * (size_t)camera->width + TILE) / TILE + 1;
  const size_t rows = (3 * (size_t)camera->height + TILE) / TILE + 1;
  return columns * rows * TILE_CELLS * TILE_CELLS;
}

static void mark_rect(const pl_outline_cells *to, pl_rect r) {
  const pl_rect box = to->box;
  const size_t first = (size_t)((r.x0 - box.x0) / CELL), last = (size_t)((r.x1 - box.x0) / CELL);
  for (int y = (r.y0 - box.y0) / CELL; y <= (r.y1 - box.y0) / CELL; y++)
    memset(to->cells + (size_t)y * to->stride + first, 1, last - first + 1);
}

/* Marks the cells that a box may project on. The rectangle of a long oblique box is much larger
 * than its projection, so large boxes are halved, at most `depth` times. Boxes that cross the
 * camera plane are not: halving costs much there and gains little. */
static void mark_box(const pl_outline_cells *to, const pl_camera *camera, const pl_outline *piece,
                     const pl_cluster *box, int depth) {
  const int small = 4 * CELL;
  const pl_rect r = pl_outline_project(piece, camera, box->low, box->high);
  if (r.x0 > r.x1)
    return;
  if (depth == 0 || (r.x1 - r.x0 < small && r.y1 - r.y0 < small) ||
      !pl_outline_before(piece, box->low, box->high)) {
    mark_rect(to, r);
    return;
  }
  int axis = 0;
  for (int k = 1; k < 3; k++)
    if (box->high[k] - box->low[k] > box->high[axis] - box->low[axis])
      axis = k;
  pl_cluster halves[2] = {*box, *box};
  halves[0].high[axis] = halves[1].low[axis] = 0.5f * (box->low[axis] + box->high[axis]);
  mark_box(to, camera, piece, &halves[0], depth - 1);
  mark_box(to, camera, piece, &halves[1], depth - 1);
}

pl_outline_cells pl_outline_cells_mark(const pl_outline *outline, const pl_camera *camera,
                                       const pl_extent *extent, uint8_t *memory) {
  const int depth = 6, anywhere = outline->model == NULL && outline->pieces == NULL;
  pl_extent box = *extent;
  size_t count;
  if (!outline->whole) {
    const pl_rect r = outline->rect;
    pl_extent_merge(&box, &(pl_extent){r.x0, r.y0, r.x1, r.y1, 0});
  }
  pl_outline_cells out = {.box = {box.x0, box.y0, box.x1, box.y1}, .cells = memory};
  out.columns = (box.x1 - box.x0 + TILE) / TILE;
  out.rows = (box.y1 - box.y0 + TILE) / TILE;
  out.stride = (size_t)out.columns * TILE_CELLS;
  memset(memory, anywhere, out.stride * (size_t)(out.rows * TILE_CELLS));
  const pl_outline *pieces = pl_outline_pieces(outline, &count);
  for (size_t k = 0; k < count && !outline->whole; k++)
    for (size_t i = 0; i < pieces[k].clusters.count; i++)
      mark_box(&out, camera, &pieces[k], &pieces[k].clusters.boxes[i], depth);
  return out;
}

pl_outline_tile pl_outline_cells_tile(const pl_outline_cells *cells, const pl_camera *camera,
                                      size_t item) {
  const int column = (int)(item % (size_t)cells->columns);
  const int row = (int)(item / (size_t)cells->columns);
  const int x0 = cells->box.x0 + TILE * column, y0 = cells->box.y0 + TILE * row;
  const int w = cells->box.x1 - x0 + 1, h = cells->box.y1 - y0 + 1;
  pl_outline_tile out = {.x0 = x0, .y0 = y0, .width = w < TILE ? w : TILE};
  out.height = h < TILE ? h : TILE;
  out.cells =
      cells->cells + (size_t)(row * TILE_CELLS) * cells->stride + (size_t)(column * TILE_CELLS);
  out.outside =
      x0 + out.width <= 0 || y0 + out.height <= 0 || x0 >= camera->width || y0 >= camera->height;
  return out;
}

static void visit_cell(const pl_outline_tile *tile, int x0, int y0, bool possible,
                       pl_outline_look look, void *context) {
  const int x1 = x0 + CELL < tile->width ? x0 + CELL : tile->width;
  const int y1 = y0 + CELL < tile->height ? y0 + CELL : tile->height;
  for (int by = y0; by < y1; by += 2)
    for (int bx = x0; bx < x1; bx += 4)
      for (int y = by; y < by + 2 && y < y1; y++)
        for (int x = bx; x < bx + 4 && x < x1; x++)
          look(context, x, y, possible);
}

void pl_outline_tile_visit(const pl_outline_tile *tile, size_t stride, pl_outline_look look,
                           void *context) {
  const uint8_t *cells = tile->cells;
  for (int y = 0; y < tile->height; y += CELL, cells += stride)
    for (int x = 0; x < tile->width; x += CELL) {
      const bool possible = cells[x / CELL] != 0;
      if (possible || !tile->outside)
        visit_cell(tile, x, y, possible, look, context);
    }
}
