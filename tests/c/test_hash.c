/* FNV-1a 64: vectors of the authors' test program (test_fnv.c); three are in RFC 9923 as well. */
#include "base/hash.h"

#include <string.h>

#include "harness.h"

static uint64_t hash_text(const char *text) { return pl_hash(PL_HASH_SEED, text, strlen(text)); }

static void known_answers(void **state) {
  (void)state;
  assert_int_equal(hash_text(""), 0xcbf29ce484222325u);
  assert_int_equal(hash_text("a"), 0xaf63dc4c8601ec8cu);
  assert_int_equal(hash_text("b"), 0xaf63df4c8601f1a5u);
  assert_int_equal(hash_text("foobar"), 0x85944171f73967e8u);
}

static void continues_where_it_stopped(void **state) {
  (void)state;
  const uint64_t half = pl_hash(PL_HASH_SEED, "foo", 3);
  assert_int_equal(pl_hash(half, "bar", 3), hash_text("foobar"));
}

static void every_byte_counts(void **state) {
  (void)state;
  unsigned char bytes[64] = {0};
  const uint64_t zero = pl_hash(PL_HASH_SEED, bytes, sizeof bytes);
  for (size_t i = 0; i < sizeof bytes; i++) {
    bytes[i] = 0x80;
    assert_int_not_equal(pl_hash(PL_HASH_SEED, bytes, sizeof bytes), zero);
    bytes[i] = 0;
  }
  assert_int_not_equal(pl_hash(PL_HASH_SEED, bytes, sizeof bytes - 1), zero);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(known_answers),
      cmocka_unit_test(continues_where_it_stopped),
      cmocka_unit_test(every_byte_counts),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
