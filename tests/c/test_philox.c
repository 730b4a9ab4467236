/* The generator against published words and NumPy. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "math/philox.h"

/* Words of Random123's kat_vectors (philox4x64-10): zeros, ones, digits of pi. */
static void test_known_blocks(void **state) {
  (void)state;
  static const struct {
    uint64_t counter[4], key[2], expected[4];
  } vectors[] = {
      {{0}, {0}, {0x16554d9eca36314c, 0xdb20fe9d672d0fdc, 0xd7e772cee186176b, 0x7e68b68aec7ba23b}},
      {{UINT64_MAX, UINT64_MAX, UINT64_MAX, UINT64_MAX},
       {UINT64_MAX, UINT64_MAX},
       {0x87b092c3013fe90b, 0x438c3c67be8d0224, 0x9cc7d7c69cd777b6, 0xa09caebf594f0ba0}},
      {{0x243f6a8885a308d3, 0x13198a2e03707344, 0xa4093822299f31d0, 0x082efa98ec4e6c89},
       {0x452821e638d01377, 0xbe5466cf34e90c6c},
       {0xa528f45403e61d95, 0x38c72dbd566e9788, 0xa5a1610e72fd18b5, 0x57bd43b5e52b7fe6}},
  };
  for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++) {
    uint64_t out[4];
    pl_philox(vectors[i].key, vectors[i].counter, out);
    assert_memory_equal(out, vectors[i].expected, sizeof out);
    memcpy(out, vectors[i].counter, sizeof out); /* in place */
    pl_philox(vectors[i].key, out, out);
    assert_memory_equal(out, vectors[i].expected, sizeof out);
  }
}

/* numpy.random.Philox(key=, counter=).random_raw(n), NumPy 2.4: order and carry. */
static void test_numpy_order(void **state) {
  (void)state;
  static const uint64_t plain[9] = {0x50ab9a7afc52647e, 0x01ba1eda3784af09, 0x5cead0cc262e3971,
                                    0x547ab0f5b3ff0c8e, 0x03561c94c5db47fe, 0x5fe088d752d69950,
                                    0x430f8630f2e34190, 0x05cf7b12fa221b8f, 0xef0cabd297501e2b};
  static const uint64_t carried[6] = {0x8bd0d1feb425a5a2, 0x3a0c3880ccdc5304, 0x59d65ff795861195,
                                      0x6c28ebddc3c32ceb, 0x6a7760a2351a2ced, 0xca73b64f59ba9597};
  uint64_t out[10] = {0};
  pl_philox_fill((uint64_t[]){123, 456}, (uint64_t[]){7, 0, 5, 9}, 9, out);
  assert_memory_equal(out, plain, sizeof plain);
  assert_int_equal(out[9], 0); /* no more than asked */
  pl_philox_fill((uint64_t[]){1, 2}, (uint64_t[]){UINT64_MAX, UINT64_MAX, 3, 4}, 6, out);
  assert_memory_equal(out, carried, sizeof carried);
}

static void test_unit_interval(void **state) {
  (void)state;
  assert_true(pl_philox_double(UINT64_MAX) < 1.0 && pl_philox_double(0) == 0.0);
  assert_true(pl_philox_double(UINT64_C(1) << 63) == 0.5);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_known_blocks),
      cmocka_unit_test(test_numpy_order),
      cmocka_unit_test(test_unit_interval),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
