/* All memory of the core is allocated here: one allocation hook, and arenas for per-frame data. */
#ifndef PL_BASE_MEMORY_H
#define PL_BASE_MEMORY_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Hook that every allocation calls. `allocate` receives the size and may return NULL to make the
 * allocation fail. Set it before any other thread runs; NULL restores malloc. */
typedef void *(*pl_allocate_fn)(void *context, size_t size);
void pl_memory_hook(pl_allocate_fn allocate, void *context);

/* Returns the number of allocations of the process so far (atomic). */
uint64_t pl_memory_allocations(void);

/* Returns zeroed memory for `count` items of `size` bytes, or NULL when out of memory or when
 * count*size overflows (the caller reports the error). A count or size of 0 gives a valid
 * pointer. */
void *pl_alloc(size_t count, size_t size);
/* Changes the number of items and keeps the content; new bytes are not zeroed. On NULL, `memory` is
 * unchanged. */
void *pl_realloc(void *memory, size_t count, size_t size);
void pl_free(void *memory);

/* Allocates into *out, or returns PL_E_MEMORY with an error text that names `what`. */
pl_status pl_alloc_or_fail(size_t count, size_t size, const char *what, void **out);

/* Returns a copy of the text made with pl_alloc, or NULL when out of memory. */
char *pl_strdup(const char *text);

/* Bump allocator. Blocks grow on demand and reset keeps them, so that a frame allocates nothing in
 * the steady state. Not thread-safe. */
typedef struct pl_arena_block pl_arena_block;
typedef struct pl_arena {
  pl_arena_block *first;   /* owned */
  pl_arena_block *current; /* block that is being filled */
} pl_arena;

void pl_arena_init(pl_arena *arena);
void pl_arena_clear(pl_arena *arena); /* frees everything */
void pl_arena_reset(pl_arena *arena); /* discards the content, keeps the blocks */
/* Returns uninitialised memory aligned to 64 bytes, or NULL when out of memory. */
void *pl_arena_alloc(pl_arena *arena, size_t count, size_t size);

#ifdef __cplusplus
}
#endif
#endif
