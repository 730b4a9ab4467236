/* Blocks for the records of tiles. */
#include "render/record_pool.h"

#include "base/memory.h"

void pl_record_pool_clear(pl_record_pool *pool) {
  for (size_t i = 0; i < pool->count; i++)
    pl_free(pool->blocks[i]);
  pl_free(pool->blocks);
}

void pl_record_pool_reset(pl_record_pool *pool) {
  pool->block = pool->used = pool->kept = pool->most = 0;
}

/* Blocks are not zeroed: the system gives no memory to pages that are never written. */
static pl_status add_block(pl_record_pool *pool) {
  if (pool->count == pool->room) {
    const size_t room = 2 * pool->room + 8;
    void **grown = pl_realloc(pool->blocks, room, sizeof *grown);
    if (grown == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for %zu blocks of light", room);
    pool->blocks = grown;
    pool->room = room;
  }
  void *block = pl_realloc(NULL, pool->length, pool->bytes);
  if (block == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory: %zu x %zu bytes for the irradiance filter",
                   pool->length, pool->bytes);
  pool->blocks[pool->count++] = block;
  return PL_OK;
}

pl_status pl_record_pool_take(pl_record_pool *pool, size_t count, void **out) {
  if (pool->used + count > pool->length) {
    pool->block++;
    pool->used = 0;
  }
  if (pool->block == pool->count)
    PL_TRY(add_block(pool));
  *out = (char *)pool->blocks[pool->block] + pool->used * pool->bytes;
  pool->used += count;
  pool->kept += count;
  pool->most = count > pool->most ? count : pool->most;
  return PL_OK;
}

/* A block is closed when the next tile does not fit. The block then has less unused room than that
 * tile needs, and the two together hold more than one full block. Each bounds the number of blocks.
 */
pl_status pl_record_pool_reserve(pl_record_pool *pool) {
  if (pool->kept == 0)
    return PL_OK;
  const size_t lacking = pool->kept / (pool->length + 1 - pool->most) + 1;
  const size_t pairs = 2 * pool->kept / pool->length + 1;
  while (pool->count < (lacking < pairs ? lacking : pairs))
    PL_TRY(add_block(pool));
  return PL_OK;
}
