/* Allocation hook and arena allocator. */
#include "base/memory.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

static void *allocate_with_malloc(void *context, size_t size) {
  (void)context;
  return malloc(size);
}

static pl_allocate_fn hook = allocate_with_malloc;
static void *hook_context;
static atomic_uint_fast64_t allocations;

void pl_memory_hook(pl_allocate_fn allocate, void *context) {
  hook = allocate != NULL ? allocate : allocate_with_malloc;
  hook_context = context;
}

uint64_t pl_memory_allocations(void) { return atomic_load(&allocations); }

static void *hooked(size_t size) {
  atomic_fetch_add_explicit(&allocations, 1, memory_order_relaxed);
  return hook(hook_context, size > 0 ? size : 1);
}

void *pl_alloc(size_t count, size_t size) {
  if (size != 0 && count > SIZE_MAX / size)
    return NULL;
  void *memory = hooked(count * size);
  if (memory != NULL)
    memset(memory, 0, count * size);
  return memory;
}

void *pl_realloc(void *memory, size_t count, size_t size) {
  if (size != 0 && count > SIZE_MAX / size)
    return NULL;
  /* The hook decides whether this allocation may happen; realloc itself moves the bytes. */
  if (hook != allocate_with_malloc) {
    void *probe = hooked(1);
    if (probe == NULL)
      return NULL;
    free(probe);
  } else {
    atomic_fetch_add_explicit(&allocations, 1, memory_order_relaxed);
  }
  return realloc(memory, count * size > 0 ? count * size : 1);
}

void pl_free(void *memory) { free(memory); }

pl_status pl_alloc_or_fail(size_t count, size_t size, const char *what, void **out) {
  *out = pl_alloc(count, size);
  if (*out == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory: %zu x %zu bytes for %s", count, size, what);
  return PL_OK;
}

char *pl_strdup(const char *text) {
  const size_t size = strlen(text) + 1;
  char *copy = pl_alloc(size, 1);
  if (copy != NULL)
    memcpy(copy, text, size);
  return copy;
}

enum { ARENA_ALIGNMENT = 64, ARENA_BLOCK = 1 << 20 };

struct pl_arena_block {
  pl_arena_block *next;
  size_t capacity; /* bytes after the header, as allocated */
  size_t used;
  unsigned char *start; /* first byte with ARENA_ALIGNMENT */
};

void pl_arena_init(pl_arena *arena) { *arena = (pl_arena){0}; }

void pl_arena_clear(pl_arena *arena) {
  pl_arena_block *block = arena->first;
  while (block != NULL) {
    pl_arena_block *next = block->next;
    pl_free(block);
    block = next;
  }
  *arena = (pl_arena){0};
}

void pl_arena_reset(pl_arena *arena) {
  for (pl_arena_block *block = arena->first; block != NULL; block = block->next)
    block->used = 0;
  arena->current = arena->first;
}

static pl_arena_block *block_create(size_t capacity) {
  if (capacity > SIZE_MAX - sizeof(pl_arena_block) - ARENA_ALIGNMENT)
    return NULL;
  pl_arena_block *block = hooked(sizeof *block + capacity + ARENA_ALIGNMENT);
  if (block == NULL)
    return NULL;
  const uintptr_t after = (uintptr_t)(block + 1);
  const uintptr_t aligned = (after + ARENA_ALIGNMENT - 1) & ~(uintptr_t)(ARENA_ALIGNMENT - 1);
  *block = (pl_arena_block){.capacity = capacity, .start = (unsigned char *)aligned};
  return block;
}

void *pl_arena_alloc(pl_arena *arena, size_t count, size_t size) {
  if (size != 0 && count > (SIZE_MAX - ARENA_ALIGNMENT) / size)
    return NULL;
  const size_t bytes = (count * size + ARENA_ALIGNMENT - 1) & ~(size_t)(ARENA_ALIGNMENT - 1);
  pl_arena_block *last = NULL;
  for (pl_arena_block *block = arena->current; block != NULL; block = block->next) {
    if (block->capacity - block->used >= bytes) {
      void *memory = block->start + block->used;
      block->used += bytes;
      arena->current = block;
      return memory;
    }
    last = block;
  }
  pl_arena_block *block = block_create(bytes > ARENA_BLOCK ? bytes : ARENA_BLOCK);
  if (block == NULL)
    return NULL;
  if (last != NULL)
    last->next = block;
  else
    arena->first = block;
  arena->current = block;
  block->used = bytes;
  return block->start;
}
