/* The table of propagators: names, times that are not finite, failing allocations of every kind
 * that has no file of its own for it. */
#include "harness.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "orbit/circular.h"
#include "orbit/elements.h"
#include "orbit/j2.h"
#include "orbit/table.h"
#include "orbit/two_body.h"

static const double TIMES[4] = {0.0, 1.0, 2.0, 3.0};
static const double VALUES[24] = {0.0};

static pl_orbit orbit(void) {
  const pl_elements el = {7e6, 0.1, 1.0, 2.0, 3.0, 4.0};
  pl_orbit out;
  assert_int_equal(pl_orbit_from_elements(&el, 4e14, &out), PL_OK);
  return out;
}

static pl_status make_kepler(pl_propagator **out) {
  const pl_orbit o = orbit();
  return pl_kepler_create(&o, PL_QUAT_IDENTITY, out);
}
static pl_status make_circular(pl_propagator **out) {
  const pl_circle circle = {{1, 2, 3}, PL_QUAT_IDENTITY, 0.0, 1.0};
  return pl_circular_create(&circle, out);
}
static pl_status make_j2(pl_propagator **out) {
  const pl_orbit o = orbit();
  const pl_flattening flattening = {1e-3, 6e6};
  return pl_j2_create(&o, flattening, true, PL_QUAT_IDENTITY, PL_QUAT_IDENTITY, out);
}
static pl_status make_table(pl_propagator **out) {
  const pl_table_rows rows = {4, TIMES, VALUES, true};
  return pl_table_create(&rows, 7, out);
}

static pl_status (*const makers[])(pl_propagator **) = {make_kepler, make_circular, make_j2,
                                                        make_table};
enum { MAKERS = sizeof makers / sizeof makers[0] };

static void test_kinds(void **state) {
  (void)state;
  size_t count;
  const pl_propagator_kind *const *kinds = pl_propagator_kinds(&count);
  assert_true(count >= MAKERS);
  for (size_t i = 0; i < count; i++) {
    assert_true(strlen(kinds[i]->doc) > 50);
    for (size_t k = 0; k < i; k++)
      assert_string_not_equal(kinds[i]->name, kinds[k]->name);
  }
  for (size_t i = 0; i < MAKERS; i++) {
    pl_propagator *made = NULL;
    assert_int_equal(makers[i](&made), PL_OK);
    size_t found = 0;
    for (size_t k = 0; k < count; k++)
      found += made->kind == kinds[k];
    assert_int_equal(found, 1);
    pl_propagator_destroy(made);
  }
  pl_propagator_destroy(NULL);
}

static void test_times(void **state) {
  (void)state;
  const double bad[3] = {NAN, INFINITY, -INFINITY};
  for (size_t i = 0; i < MAKERS; i++) {
    pl_propagator *made = NULL;
    pl_state out[2];
    assert_int_equal(makers[i](&made), PL_OK);
    for (int k = 0; k < 3; k++) {
      const double t[2] = {1.0, bad[k]};
      assert_int_equal(pl_propagator_states(made, 2, t, out), PL_E_RANGE);
      assert_non_null(strstr(pl_error_text(), "time 1 is "));
    }
    assert_int_equal(pl_propagator_states(made, 0, NULL, NULL), PL_OK);
    pl_propagator_destroy(made);
  }
}

static void *fail_nth(void *context, size_t size) {
  int *left = context;
  return (*left)-- == 0 ? NULL : malloc(size);
}

/* Leaks are the sanitizer's to report. */
static void test_failing_allocations(void **state) {
  (void)state;
  for (size_t i = 0; i < MAKERS; i++) {
    pl_status status = PL_E_MEMORY;
    int n = 0;
    for (; n < 10 && status != PL_OK; n++) {
      int left = n;
      pl_propagator *made = NULL;
      pl_memory_hook(fail_nth, &left);
      status = makers[i](&made);
      pl_memory_hook(NULL, NULL);
      assert_true(status == PL_OK || (status == PL_E_MEMORY && !made));
      pl_propagator_destroy(made);
    }
    assert_true(n > 1 && status == PL_OK);
  }
}

/* Once made, a propagator allocates nothing. */
static void test_no_allocations(void **state) {
  (void)state;
  for (size_t i = 0; i < MAKERS; i++) {
    pl_propagator *made = NULL;
    pl_state out[4];
    assert_int_equal(makers[i](&made), PL_OK);
    const uint64_t before = pl_memory_allocations();
    assert_int_equal(pl_propagator_states(made, 4, TIMES, out), PL_OK);
    assert_int_equal(pl_memory_allocations(), before);
    pl_propagator_destroy(made);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_kinds),
      cmocka_unit_test(test_times),
      cmocka_unit_test(test_failing_allocations),
      cmocka_unit_test(test_no_allocations),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
