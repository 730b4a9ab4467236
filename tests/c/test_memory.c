/* The allocation functions and their hook: zeroing, overflow, counting, failing the n-th. */
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

#include "harness.h"

/* Lets `left` allocations pass, then fails every further one. */
typedef struct budget {
  int left;
  size_t last_size;
} budget;

static void *allocate_within(void *context, size_t size) {
  budget *budget = context;
  budget->last_size = size;
  if (budget->left == 0)
    return NULL;
  budget->left--;
  return malloc(size);
}

static int restore_hook(void **state) {
  (void)state;
  pl_memory_hook(NULL, NULL);
  return 0;
}

static void memory_is_zeroed(void **state) {
  (void)state;
  for (int round = 0; round < 8; round++) { /* freed blocks come back dirty */
    unsigned char *bytes = pl_alloc(1000, 3);
    assert_non_null(bytes);
    for (size_t i = 0; i < 3000; i++)
      assert_int_equal(bytes[i], 0);
    memset(bytes, 0xff, 3000);
    pl_free(bytes);
  }
}

static void nothing_is_still_a_valid_pointer(void **state) {
  (void)state;
  void *a = pl_alloc(0, 8);
  void *b = pl_alloc(8, 0);
  assert_non_null(a);
  assert_non_null(b);
  assert_ptr_not_equal(a, b);
  pl_free(a);
  pl_free(b);
  pl_free(NULL);
}

static void an_overflowing_size_is_refused(void **state) {
  (void)state;
  /* volatile: compilers warn about sizes they can see are absurd */
  volatile size_t huge = SIZE_MAX / 2;
  assert_null(pl_alloc(huge, 3));
  assert_null(pl_alloc(3, huge));
  void *kept = pl_alloc(4, 1);
  memcpy(kept, "keep", 4);
  assert_null(pl_realloc(kept, huge, 3));
  assert_memory_equal(kept, "keep", 4);
  pl_free(kept);
}

static void realloc_keeps_the_content(void **state) {
  (void)state;
  int *numbers = pl_realloc(NULL, 10, sizeof *numbers);
  assert_non_null(numbers);
  for (int i = 0; i < 10; i++)
    numbers[i] = i * i;
  numbers = pl_realloc(numbers, 100000, sizeof *numbers);
  assert_non_null(numbers);
  for (int i = 0; i < 10; i++)
    assert_int_equal(numbers[i], i * i);
  numbers = pl_realloc(numbers, 5, sizeof *numbers);
  assert_non_null(numbers);
  for (int i = 0; i < 5; i++)
    assert_int_equal(numbers[i], i * i);
  pl_free(numbers);
}

static void a_failed_realloc_leaves_the_memory(void **state) {
  (void)state;
  char *text = pl_strdup("unchanged");
  budget none = {0};
  pl_memory_hook(allocate_within, &none);
  assert_null(pl_realloc(text, 1000, 1));
  assert_string_equal(text, "unchanged");
  pl_free(text);
}

static void every_allocation_is_counted(void **state) {
  (void)state;
  const uint64_t before = pl_memory_allocations();
  void *a = pl_alloc(1, 1);
  assert_int_equal(pl_memory_allocations() - before, 1);
  a = pl_realloc(a, 2, 1);
  assert_int_equal(pl_memory_allocations() - before, 2);
  char *b = pl_strdup("b");
  assert_int_equal(pl_memory_allocations() - before, 3);
  pl_free(a);
  pl_free(b);
  assert_int_equal(pl_memory_allocations() - before, 3);
}

static void the_hook_sees_sizes_and_can_fail(void **state) {
  (void)state;
  budget two = {.left = 2};
  pl_memory_hook(allocate_within, &two);
  void *a = pl_alloc(7, 3);
  assert_non_null(a);
  assert_int_equal(two.last_size, 21);
  char *b = pl_strdup("four");
  assert_string_equal(b, "four");
  assert_int_equal(two.last_size, 5);
  assert_null(pl_alloc(1, 1));
  assert_null(pl_strdup("no"));
  pl_free(a);
  pl_free(b);
}

static void alloc_or_fail_says_what_for(void **state) {
  (void)state;
  void *memory = NULL;
  assert_int_equal(pl_alloc_or_fail(3, 4, "the map", &memory), PL_OK);
  assert_non_null(memory);
  pl_free(memory);
  budget none = {0};
  pl_memory_hook(allocate_within, &none);
  assert_int_equal(pl_alloc_or_fail(3, 4, "the map", &memory), PL_E_MEMORY);
  assert_null(memory);
  assert_non_null(strstr(pl_error_text(), "the map"));
}

#define WITH_HOOK(test) cmocka_unit_test_teardown(test, restore_hook)

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(memory_is_zeroed),
      cmocka_unit_test(nothing_is_still_a_valid_pointer),
      cmocka_unit_test(an_overflowing_size_is_refused),
      cmocka_unit_test(realloc_keeps_the_content),
      WITH_HOOK(a_failed_realloc_leaves_the_memory),
      cmocka_unit_test(every_allocation_is_counted),
      WITH_HOOK(the_hook_sees_sizes_and_can_fail),
      WITH_HOOK(alloc_or_fail_says_what_for),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
