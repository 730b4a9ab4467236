/* The arena: alignment, growth, and no allocation once it has grown. */
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

#include "harness.h"

enum { MEGABYTE = 1 << 20 };

static void *refuse(void *context, size_t size) {
  (void)context;
  (void)size;
  return NULL;
}

static int restore_hook(void **state) {
  (void)state;
  pl_memory_hook(NULL, NULL);
  return 0;
}

static void pieces_are_aligned_and_do_not_overlap(void **state) {
  (void)state;
  enum { PIECES = 200 };
  pl_arena arena;
  unsigned char *pieces[PIECES];
  pl_arena_init(&arena);
  for (size_t i = 0; i < PIECES; i++) {
    pieces[i] = pl_arena_alloc(&arena, i * 37, 3);
    assert_non_null(pieces[i]);
    assert_int_equal((uintptr_t)pieces[i] % 64, 0);
    memset(pieces[i], (int)i, i * 37 * 3);
  }
  for (size_t i = 0; i < PIECES; i++)
    for (size_t j = 0; j < i * 37 * 3; j++)
      assert_int_equal(pieces[i][j], (unsigned char)i);
  pl_arena_clear(&arena);
}

/* What a frame might ask for: small pieces, one above the block size, small ones again. */
static void fill(pl_arena *arena, void *pieces[static 40]) {
  for (size_t i = 0; i < 40; i++) {
    pieces[i] = pl_arena_alloc(arena, i == 20 ? 3 * MEGABYTE : 90000, 1);
    assert_non_null(pieces[i]);
  }
}

static void the_second_frame_allocates_nothing(void **state) {
  (void)state;
  pl_arena arena;
  void *first[40];
  void *second[40];
  pl_arena_init(&arena);
  fill(&arena, first);
  const uint64_t allocations = pl_memory_allocations();
  for (int frame = 0; frame < 5; frame++) {
    pl_arena_reset(&arena);
    fill(&arena, second);
    assert_memory_equal(first, second, sizeof first);
  }
  assert_int_equal(pl_memory_allocations(), allocations);
  pl_arena_clear(&arena);
}

static void zero_items_are_a_valid_pointer(void **state) {
  (void)state;
  pl_arena arena;
  pl_arena_init(&arena);
  assert_non_null(pl_arena_alloc(&arena, 0, 8));
  assert_non_null(pl_arena_alloc(&arena, 8, 0));
  pl_arena_clear(&arena);
}

static void sizes_that_overflow_are_refused(void **state) {
  (void)state;
  volatile size_t huge = SIZE_MAX / 2;
  pl_arena arena;
  pl_arena_init(&arena);
  assert_null(pl_arena_alloc(&arena, huge, 3));
  assert_null(pl_arena_alloc(&arena, SIZE_MAX, 1));
  assert_null(pl_arena_alloc(&arena, SIZE_MAX - 64, 1));
  assert_null(pl_arena_alloc(&arena, SIZE_MAX - 200, 1));
  assert_non_null(pl_arena_alloc(&arena, 100, 1));
  pl_arena_clear(&arena);
}

static void a_refused_block_leaves_the_arena_usable(void **state) {
  (void)state;
  pl_arena arena;
  pl_arena_init(&arena);
  unsigned char *kept = pl_arena_alloc(&arena, 100, 1);
  assert_non_null(kept);
  memset(kept, 7, 100);
  pl_memory_hook(refuse, NULL);
  assert_null(pl_arena_alloc(&arena, 2 * MEGABYTE, 1));
  assert_non_null(pl_arena_alloc(&arena, 100, 1)); /* fits what is there */
  pl_memory_hook(NULL, NULL);
  assert_non_null(pl_arena_alloc(&arena, 2 * MEGABYTE, 1));
  for (size_t i = 0; i < 100; i++)
    assert_int_equal(kept[i], 7);
  pl_arena_clear(&arena);
}

static void a_cleared_arena_is_empty_and_reusable(void **state) {
  (void)state;
  pl_arena arena;
  pl_arena_init(&arena);
  pl_arena_clear(&arena);
  assert_null(arena.first);
  pl_arena_reset(&arena);
  assert_non_null(pl_arena_alloc(&arena, 10, 10));
  assert_non_null(arena.first);
  pl_arena_clear(&arena);
  assert_null(arena.first);
  assert_null(arena.current);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pieces_are_aligned_and_do_not_overlap),
      cmocka_unit_test(the_second_frame_allocates_nothing),
      cmocka_unit_test(zero_items_are_a_valid_pointer),
      cmocka_unit_test(sizes_that_overflow_are_refused),
      cmocka_unit_test_teardown(a_refused_block_leaves_the_arena_usable, restore_hook),
      cmocka_unit_test(a_cleared_arena_is_empty_and_reusable),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
