/* What every C test includes: cmocka with the headers it needs before it. */
#ifndef PL_TESTS_HARNESS_H
#define PL_TESTS_HARNESS_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

/* A count of random draws, scenes or grid points: `all`, but `few` where a sanitizer watches. That
 * build makes each ten times slower and looks for faults of memory and arithmetic, which the same
 * code shows in its first draws; what the number of draws proves is proven by the plain build.
 * Tolerances that depend on the count are written with it. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || defined(PL_FEW_DRAWS)
#define PL_DRAWS(all, few) (few)
#else
#define PL_DRAWS(all, few) (all)
#endif

/* Whether random scenes showed what a test looks for more than `least` times. By chance, few scenes
 * never show it: where PL_DRAWS takes few, every count will do. */
#define PL_SEEN(count, least) ((count) > PL_DRAWS(least, -1))

/* Runs instead of a test that a sanitizer has nothing to find in. */
static inline void pl_skip_test(void **state) {
  (void)state;
  skip();
}
static inline CMUnitTestFunction pl_skip_instead(CMUnitTestFunction test) {
  (void)test;
  return pl_skip_test;
}

/* A test of what many samples converge to. Sanitizers do not run it: the same code in frames of few
 * samples, which other tests of its file render, has the same faults to show. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define converging_unit_test(test)                                                                 \
  { #test, pl_skip_instead(test), NULL, NULL, NULL }
#else
#define converging_unit_test(test) cmocka_unit_test(test)
#endif

/* A test that runs on one thread, in a program that has others on several: ThreadSanitizer has
 * nothing to find in it, and does not run it. */
#if defined(__SANITIZE_THREAD__)
#define serial_unit_test(test)                                                                     \
  { #test, pl_skip_instead(test), NULL, NULL, NULL }
#else
#define serial_unit_test(test) cmocka_unit_test(test)
#endif

#endif
