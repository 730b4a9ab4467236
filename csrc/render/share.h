/* Light from other surfaces, shared between pixels. What reaches a rough surface by way of others
 * changes little from pixel to pixel, but the paths of one pixel find it by luck. So only some are
 * followed, and patches of one smooth surface in neighbouring pixels pool what their paths bring,
 * over what these carry on: colours stay sharp. A pool reaches no farther than it must to be quiet,
 * so that with more samples it is the pixel's own. */
#ifndef PL_RENDER_SHARE_H
#define PL_RENDER_SHARE_H

#include <pthread.h>

#include "render/path.h"

/* What is kept of a tile until all are sampled. */
typedef struct pl_share_tile {
  bool lit;          /* by others, anywhere; what follows is not valid without */
  pl_patch *patches; /* in a block, pixel by pixel */
  pl_tile tile;
  uint32_t start[PL_TILE_PIXELS + 1]; /* of each pixel's patches */
  float each[PL_TILE_PIXELS];         /* 1 over the samples of a pixel */
  pl_vec3f rest[PL_TILE_PIXELS];      /* radiance but for what is shared, W m-2 sr-1 */
} pl_share_tile;

/* Any tile's patches fit into a block. */
enum { PL_SHARE_BLOCK = PL_TILE_PIXELS * PL_PATCHES };

/* Kept from frame to frame: what moves from tile to tile takes no new memory. */
typedef struct pl_share {
  pthread_mutex_t lock; /* on the blocks */
  pl_patch **blocks;    /* owned, and what they point at */
  size_t block_count, block_room;
  size_t block, used;   /* the one that is being filled, and patches in it */
  pl_share_tile *tiles; /* owned, rows of `columns`; the first of them is `row0` of the image */
  int columns, rows, row0;
  size_t room; /* in tiles */
} pl_share;

pl_status pl_share_init(pl_share *share);
/* Forgets all tiles and makes room for those of an image, or of some rows of tiles. */
pl_status pl_share_start(pl_share *share, int columns, int rows, int row0);
void pl_share_clear(pl_share *share);

/* Makes means of the sums of a tile that is sampled. If light is shared in it, what is needed for
 * that is kept, and radiance is without it. Each item by one worker. */
pl_status pl_share_keep(pl_share *share, size_t item, const pl_path_context *context,
                        pl_tile_buffers *buffers);

/* Radiance of a tile that is lit, when all are kept. */
void pl_share_light(const pl_share *share, size_t item, const pl_render_settings *settings,
                    double pixel_rad, pl_vec3f radiance[PL_TILE_PIXELS]);

#endif
