/* Record of the indirect light of each pixel, for the irradiance filter. Light that reaches a rough
 * surface by way of others changes little from pixel to pixel, but the few paths of one pixel find
 * it by chance. So only some paths are followed, and patches of one smooth surface in neighbouring
 * pixels share their paths' radiance, divided by the throughput so that colours stay sharp. The
 * filter is no wider than it must be to be free of visible noise, so that with more samples it
 * converges to the pixel's own light. */
#ifndef PL_RENDER_IRRADIANCE_RECORD_H
#define PL_RENDER_IRRADIANCE_RECORD_H

#include <pthread.h>

#include "render/path.h"
#include "render/record_pool.h"

/* Of each run of this many samples the first few are followed beyond the first surface; fewer of
 * them in frames that have no more samples than one run. */
enum { PL_IRRADIANCE_ROW = 8 };

/* Pixels are grouped into square cells that start at even rows and columns of the image. */
enum { PL_CELL = 2, PL_CELL_SIDE = PL_TILE_SIDE / PL_CELL, PL_CELLS = PL_CELL_SIDE * PL_CELL_SIDE };

/* One surface in one cell, as the filter reads it. */
typedef struct pl_irradiance_cell {
  pl_spot spot;
  pl_vec3f filtered, weight; /* sums over the followed paths of its patches */
  float square;              /* sum of their squared luminances */
  float count;               /* number of these paths */
  float pixels;              /* number of pixels that have such paths */
  /* Sums for the analysis of variance, luminances: the squared radiance over the throughput, of
   * each path and of all paths of a pixel together; and the squared throughput of all paths of a
   * pixel. */
  float each, together, weight_square;
} pl_irradiance_cell;

/* Record of a pixel's patch. */
typedef struct pl_irradiance_patch {
  uint16_t pixel;  /* index in the tile */
  uint16_t cell;   /* index of the pl_irradiance_cell within its cell */
  uint32_t lit;    /* number of followed paths */
  float part;      /* fraction of the pixel's samples that continued into a wide lobe */
  float level;     /* luminance without the filtered light */
  pl_vec3f weight; /* weight of the filtered light in the pixel's mean */
  pl_vec3f filtered, lit_weight; /* as in pl_patch */
} pl_irradiance_patch;

/* Record of a tile, kept until those around it are sampled. */
typedef struct pl_irradiance_tile {
  bool lit;                     /* some patch has indirect light; the rest is valid only if true */
  pl_irradiance_patch *patches; /* in a pool, ordered by cell */
  pl_irradiance_cell *cells;    /* likewise */
  pl_tile tile;
  uint32_t patch_start[PL_CELLS + 1], cell_start[PL_CELLS + 1];
  pl_vec3f rest[PL_TILE_PIXELS]; /* radiance without the filtered light, W m-2 sr-1 */
} pl_irradiance_tile;

/* Room for the records of some rows of tiles. */
typedef struct pl_irradiance_half {
  pl_record_pool patches, cells;
} pl_irradiance_half;

/* Large images are sampled in bands of rows of tiles: filters reach no farther than the next tile,
 * so that only the tiles of a band and of the one before it are held. Kept from frame to frame:
 * light that moves from tile to tile needs no new memory. */
typedef struct pl_irradiance_record {
  pthread_mutex_t lock;       /* guards the pools */
  pl_irradiance_half half[2]; /* of bands with even and with odd numbers */
  int current;                /* that of the present band */
  pl_irradiance_tile *tiles;  /* owned; `held` rows of `columns` */
  int columns, rows;          /* of the image, or of the rows of it that are rendered */
  int band;                   /* rows of a band */
  int held;                   /* row r is at r % held */
  size_t room;                /* capacity of `tiles` */
} pl_irradiance_record;

static inline pl_irradiance_tile *pl_irradiance_tile_at(const pl_irradiance_record *irradiance,
                                                        int row, int column) {
  return &irradiance->tiles[row % irradiance->held * irradiance->columns + column];
}

pl_status pl_irradiance_init(pl_irradiance_record *irradiance);
/* Drops all tiles and sets the size of an image, or of some of its rows of tiles, and of bands:
 * they are long enough for the threads to share. */
pl_status pl_irradiance_start(pl_irradiance_record *irradiance, int columns, int rows, int threads);
/* Begins the band from a row on, and drops all tiles but those of the band before. */
void pl_irradiance_turn(pl_irradiance_record *irradiance, int row);
void pl_irradiance_clear(pl_irradiance_record *irradiance);

/* Turns the sums of a sampled tile into means. If light is filtered in the tile, keeps the data for
 * the filter, and leaves that light out of the radiance. Each tile is handled by one worker. */
pl_status pl_irradiance_keep(pl_irradiance_record *irradiance, int row, int column,
                             const pl_path_context *context, pl_tile_buffers *buffers);

/* To be called when all tiles of a band are kept: allocates enough room for the same tiles in any
 * other order. Threads finish tiles in an order that varies from run to run. */
pl_status pl_irradiance_reserve(pl_irradiance_record *irradiance);

#endif
