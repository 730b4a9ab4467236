/* Status names and the error text, which is kept per thread. */
#include "base/status.h"

#include <pthread.h>
#include <string.h>

#include "harness.h"

static void every_status_has_its_own_name(void **state) {
  (void)state;
  for (int i = 0; i < PL_STATUS_COUNT; i++) {
    const char *name = pl_status_name((pl_status)i);
    assert_non_null(name);
    assert_string_not_equal(name, "");
    assert_string_not_equal(name, "unknown status");
    for (int j = 0; j < i; j++)
      assert_string_not_equal(name, pl_status_name((pl_status)j));
  }
}

static void a_status_out_of_range_is_named_so(void **state) {
  (void)state;
  assert_string_equal(pl_status_name(PL_STATUS_COUNT), "unknown status");
  assert_string_equal(pl_status_name((pl_status)-1), "unknown status");
}

static void fail_gives_back_the_status_and_keeps_the_text(void **state) {
  (void)state;
  assert_int_equal(pl_fail(PL_E_RANGE, "key '%s' is %d", "speed", 7), PL_E_RANGE);
  assert_string_equal(pl_error_text(), "key 'speed' is 7");
}

static void a_text_can_be_wrapped_in_another(void **state) {
  (void)state;
  pl_fail(PL_E_FORMAT, "bad chunk");
  pl_fail(PL_E_FORMAT, "%s: %s", "model.glb", pl_error_text());
  assert_string_equal(pl_error_text(), "model.glb: bad chunk");
}

static void a_long_text_is_cut_not_overrun(void **state) {
  (void)state;
  static char text[5000];
  memset(text, 'x', sizeof text - 1);
  pl_fail(PL_E_IO, "%s", text);
  const size_t length = strlen(pl_error_text());
  assert_in_range(length, 200, sizeof text - 2);
  assert_memory_equal(pl_error_text(), text, length);
}

static void *fail_elsewhere(void *seen) {
  *(int *)seen = pl_error_text()[0] == '\0';
  pl_fail(PL_E_IO, "from the other thread");
  return NULL;
}

static void threads_do_not_see_each_others_text(void **state) {
  (void)state;
  pthread_t thread;
  int began_empty = 0;
  pl_fail(PL_E_IO, "mine");
  assert_int_equal(pthread_create(&thread, NULL, fail_elsewhere, &began_empty), 0);
  assert_int_equal(pthread_join(thread, NULL), 0);
  assert_true(began_empty);
  assert_string_equal(pl_error_text(), "mine");
}

static void names_are_listed_as_far_as_there_is_room(void **state) {
  (void)state;
  char text[16] = "";
  pl_names_append(text, sizeof text, "kepler");
  assert_string_equal(text, "kepler");
  pl_names_append(text, sizeof text, "j2");
  assert_string_equal(text, "kepler, j2");
  pl_names_append(text, sizeof text, "table");
  assert_string_equal(text, "kepler, j2, tab");
  pl_names_append(text, sizeof text, "tle");
  assert_string_equal(text, "kepler, j2, tab");
}

static int steps_done;

static pl_status three_steps(pl_status second) {
  steps_done = 1;
  PL_TRY(second);
  steps_done = 2;
  return PL_OK;
}

static void try_returns_early_on_failure_only(void **state) {
  (void)state;
  assert_int_equal(three_steps(PL_OK), PL_OK);
  assert_int_equal(steps_done, 2);
  assert_int_equal(three_steps(PL_E_DEVICE), PL_E_DEVICE);
  assert_int_equal(steps_done, 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_status_has_its_own_name),
      cmocka_unit_test(a_status_out_of_range_is_named_so),
      cmocka_unit_test(fail_gives_back_the_status_and_keeps_the_text),
      cmocka_unit_test(a_text_can_be_wrapped_in_another),
      cmocka_unit_test(a_long_text_is_cut_not_overrun),
      cmocka_unit_test(threads_do_not_see_each_others_text),
      cmocka_unit_test(names_are_listed_as_far_as_there_is_room),
      cmocka_unit_test(try_returns_early_on_failure_only),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
