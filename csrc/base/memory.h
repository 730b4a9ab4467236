/* All memory of the core: one allocation hook, and arenas for what lives one frame. */
#ifndef PL_BASE_MEMORY_H
#define PL_BASE_MEMORY_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The hook that every allocation passes. `allocate` receives the size and may return NULL to
 * make the allocation fail. Set before any other thread runs; NULL restores malloc. */
typedef void *(*pl_allocate_fn)(void *context, size_t size);
void pl_memory_hook(pl_allocate_fn allocate, void *context);

/* Number of allocations made by the process so far (atomic). */
uint64_t pl_memory_allocations(void);

/* Zeroed memory for `count` items of `size` bytes; NULL when out of memory or count*size
 * overflows (the caller reports). count or size 0 gives a valid pointer. */
void *pl_alloc(size_t count, size_t size);
/* Changes the item count, keeps content; new bytes are not zeroed. NULL leaves `memory` as it was.
 */
void *pl_realloc(void *memory, size_t count, size_t size);
void pl_free(void *memory);

/* Allocates into *out or returns PL_E_MEMORY with a text naming `what`. */
pl_status pl_alloc_or_fail(size_t count, size_t size, const char *what, void **out);

/* Text copied with pl_alloc; NULL when out of memory. */
char *pl_strdup(const char *text);

/* A bump allocator: blocks grow on demand and are kept by reset, so that in the steady state a
 * frame allocates nothing. Not thread-safe. */
typedef struct pl_arena_block pl_arena_block;
typedef struct pl_arena {
  pl_arena_block *first;   /* owned */
  pl_arena_block *current; /* block being filled */
} pl_arena;

void pl_arena_init(pl_arena *arena);
void pl_arena_clear(pl_arena *arena); /* frees everything */
void pl_arena_reset(pl_arena *arena); /* forgets content, keeps blocks */
/* Uninitialised memory aligned to 64 bytes, or NULL when out of memory. */
void *pl_arena_alloc(pl_arena *arena, size_t count, size_t size);

#ifdef __cplusplus
}
#endif
#endif
