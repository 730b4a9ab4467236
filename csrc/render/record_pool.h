/* Room for the records of tiles, in blocks that stay where they are and are used again. */
#ifndef PL_RENDER_RECORD_POOL_H
#define PL_RENDER_RECORD_POOL_H

#include <stddef.h>

#include "base/status.h"

typedef struct pl_record_pool {
  size_t bytes;  /* of a record */
  size_t length; /* records in a block: as many as a tile may have, or more */
  void **blocks; /* owned, as are the blocks */
  size_t count, room;
  size_t block, used; /* the block that is being filled, and the number of records in it */
  size_t kept, most;  /* number of records of all tiles so far, and of the largest tile */
} pl_record_pool;

void pl_record_pool_clear(pl_record_pool *pool);
/* Drops all records. */
void pl_record_pool_reset(pl_record_pool *pool);
/* Takes consecutive room for the records of one tile; it is not zeroed. */
pl_status pl_record_pool_take(pl_record_pool *pool, size_t count, void **out);
/* Allocates enough blocks for the tiles that are kept in any other order. */
pl_status pl_record_pool_reserve(pl_record_pool *pool);

#endif
