/* Light from other surfaces, shared between pixels. What reaches a rough surface by way of others
 * changes little from pixel to pixel, but the paths of one pixel find it by luck. So only some are
 * followed, and patches of one smooth surface in neighbouring pixels pool what their paths bring,
 * over what these carry on: colours stay sharp. A pool reaches no farther than it must to be quiet,
 * so that with more samples it is the pixel's own. */
#ifndef PL_RENDER_IRRADIANCE_RECORD_H
#define PL_RENDER_IRRADIANCE_RECORD_H

#include <pthread.h>

#include "render/path.h"

/* Of so many samples in a row the first few are followed beyond the first surface; fewer of them in
 * frames of no more samples. */
enum { PL_IRRADIANCE_ROW = 8 };

/* Pixels are merged into square cells, from an even row and column of the image on. */
enum { PL_CELL = 2, PL_CELL_SIDE = PL_TILE_SIDE / PL_CELL, PL_CELLS = PL_CELL_SIDE * PL_CELL_SIDE };

/* What a cell sees of one surface: what a pool takes from it. */
typedef struct pl_irradiance_cell {
  pl_spot spot;
  pl_vec3f shared, weight; /* of its patches: sums over the paths that were followed */
  float square;            /* sum of their squared luminances */
  float count;             /* of these paths */
  float pixels;            /* that have some */
  /* Sums of what paths bring, squared, over what they carry on, luminances: of each path, and of
   * all of a pixel together; and of what all of a pixel carry on, squared. */
  float each, together, weight_square;
} pl_irradiance_cell;

/* What is left of a pixel's patch. */
typedef struct pl_irradiance_patch {
  uint16_t pixel;              /* of the tile */
  uint16_t cell;               /* which of those of its cell it is in */
  uint32_t lit;                /* paths that were followed */
  float part;                  /* of the pixel's samples that went on into a wide lobe */
  float level;                 /* luminance but for what is shared */
  pl_vec3f weight;             /* of light that is shared, in the pixel's mean */
  pl_vec3f shared, lit_weight; /* as of pl_patch */
} pl_irradiance_patch;

/* What is kept of a tile until all are sampled. */
typedef struct pl_irradiance_tile {
  bool lit;                     /* by others, anywhere; what follows is not valid without */
  pl_irradiance_patch *patches; /* in a block, cell by cell */
  pl_irradiance_cell *cells;    /* likewise */
  pl_tile tile;
  uint32_t patch_start[PL_CELLS + 1], cell_start[PL_CELLS + 1];
  pl_vec3f rest[PL_TILE_PIXELS]; /* radiance but for what is shared, W m-2 sr-1 */
} pl_irradiance_tile;

/* Any tile's patches fit into a block, and their cells, which are no more. */
enum { PL_IRRADIANCE_BLOCK = PL_TILE_PIXELS * PL_PATCHES };

typedef struct pl_irradiance_block {
  pl_irradiance_patch patches[PL_IRRADIANCE_BLOCK];
  pl_irradiance_cell cells[PL_IRRADIANCE_BLOCK];
} pl_irradiance_block;

/* Kept from frame to frame: what moves from tile to tile takes no new memory. */
typedef struct pl_irradiance_record {
  pthread_mutex_t lock;         /* on the blocks */
  pl_irradiance_block **blocks; /* owned, and what they point at */
  size_t block_count, block_room;
  size_t block, used; /* the one that is being filled, and patches in it */
  size_t kept, most;  /* patches of all tiles so far, and of the tile that has most */
  pl_irradiance_tile
      *tiles; /* owned, rows of `columns`; the first of them is `row0` of the image */
  int columns, rows, row0;
  size_t room; /* in tiles */
} pl_irradiance_record;

pl_status pl_irradiance_init(pl_irradiance_record *share);
/* Forgets all tiles and makes room for those of an image, or of some rows of tiles. */
pl_status pl_irradiance_start(pl_irradiance_record *share, int columns, int rows, int row0);
void pl_irradiance_clear(pl_irradiance_record *share);

/* Makes means of the sums of a tile that is sampled. If light is shared in it, what is needed for
 * that is kept, and radiance is without it. Each item by one worker. */
pl_status pl_irradiance_keep(pl_irradiance_record *share, size_t item,
                             const pl_path_context *context, pl_tile_buffers *buffers);

/* When all are kept: makes room for the same tiles in any other order, which is that in which
 * threads finish them. */
pl_status pl_irradiance_reserve(pl_irradiance_record *share);

#endif
