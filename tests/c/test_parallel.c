/* Parallel-for: every item once, failures, cancellation. Run under the thread sanitizer too. */
#include "base/parallel.h"

#include <stdlib.h>
#include <string.h>

#include "base/work.h"
#include "harness.h"

enum { ITEMS = 5000, MAX_WORKERS = 300 };

typedef struct tally {
  atomic_int done[ITEMS];
  atomic_int total;
  int threads;
  size_t fail_from; /* items from here on fail */
  size_t per_worker[MAX_WORKERS];
} tally;

static tally *tally_create(void) {
  tally *tally = calloc(1, sizeof *tally);
  assert_non_null(tally);
  tally->fail_from = ITEMS;
  return tally;
}

static pl_status count_item(void *context, size_t item, int worker) {
  tally *tally = context;
  if (worker < 0 || worker >= tally->threads || worker >= MAX_WORKERS)
    return pl_fail(PL_E_ARGUMENT, "worker %d of %d", worker, tally->threads);
  tally->per_worker[worker]++; /* not atomic: a worker's memory is its own */
  atomic_fetch_add(&tally->done[item], 1);
  atomic_fetch_add(&tally->total, 1);
  if (item >= tally->fail_from)
    return pl_fail(PL_E_FORMAT, "item %zu is broken", item);
  return PL_OK;
}

static void every_item_is_done_once(void **state) {
  (void)state;
  const int thread_counts[] = {1, 2, 3, 16, 1000};
  const size_t item_counts[] = {0, 1, 2, 17, ITEMS};
  for (size_t t = 0; t < sizeof thread_counts / sizeof *thread_counts; t++) {
    for (size_t n = 0; n < sizeof item_counts / sizeof *item_counts; n++) {
      tally *tally = tally_create();
      tally->threads = thread_counts[t];
      const size_t count = item_counts[n];
      assert_int_equal(pl_parallel_for(thread_counts[t], count, count_item, tally, NULL), PL_OK);
      for (size_t i = 0; i < ITEMS; i++)
        assert_int_equal(atomic_load(&tally->done[i]), i < count ? 1 : 0);
      size_t sum = 0;
      for (size_t w = 0; w < MAX_WORKERS; w++)
        sum += tally->per_worker[w];
      assert_int_equal(sum, count);
      free(tally);
    }
  }
}

static pl_status add_work(void *context, size_t item, int worker) {
  (void)context;
  (void)worker;
  pl_work_add(PL_WORK_samples, item);
  return PL_OK;
}

static void work_of_all_threads_is_the_callers(void **state) {
  (void)state;
  const int thread_counts[] = {1, 2, 16};
  for (size_t i = 0; i < 3; i++) {
    const pl_work_counts before = pl_work_done;
    assert_int_equal(pl_parallel_for(thread_counts[i], ITEMS, add_work, NULL, NULL), PL_OK);
    const pl_work_counts done = pl_work_since(&before);
    for (int k = 0; k < PL_WORK_COUNT; k++)
      assert_int_equal(done.of[k], k == PL_WORK_samples ? ITEMS * (ITEMS - 1) / 2 : 0);
  }
}

static void no_threads_is_a_bad_argument(void **state) {
  (void)state;
  tally *tally = tally_create();
  assert_int_equal(pl_parallel_for(0, 3, count_item, tally, NULL), PL_E_ARGUMENT);
  assert_int_equal(pl_parallel_for(-1, 3, count_item, tally, NULL), PL_E_ARGUMENT);
  assert_int_equal(atomic_load(&tally->total), 0);
  free(tally);
}

static void a_failure_stops_the_rest_and_its_text_arrives(void **state) {
  (void)state;
  for (int threads = 1; threads <= 8; threads *= 2) {
    tally *tally = tally_create();
    tally->threads = threads;
    tally->fail_from = 100;
    pl_fail(PL_E_IO, "an older text");
    assert_int_equal(pl_parallel_for(threads, ITEMS, count_item, tally, NULL), PL_E_FORMAT);
    /* Items are handed out in order, so 100 is always among those seen, and is the lowest. */
    assert_string_equal(pl_error_text(), "item 100 is broken");
    for (size_t i = 0; i <= 100; i++)
      assert_int_equal(atomic_load(&tally->done[i]), 1);
    if (threads == 1)
      assert_int_equal(atomic_load(&tally->total), 101);
    free(tally);
  }
}

static void a_token_set_before_lets_nothing_run(void **state) {
  (void)state;
  tally *tally = tally_create();
  tally->threads = 4;
  pl_cancel cancel = {0};
  atomic_store(&cancel.requested, true);
  assert_int_equal(pl_parallel_for(4, ITEMS, count_item, tally, &cancel), PL_E_CANCELLED);
  assert_int_equal(atomic_load(&tally->total), 0);
  free(tally);
}

typedef struct polls {
  int count;
  int cancel_at;
} polls;

static bool count_polls(void *context) {
  polls *polls = context;
  return ++polls->count >= polls->cancel_at;
}

static void the_poll_cancels_from_the_calling_thread(void **state) {
  (void)state;
  for (int threads = 1; threads <= 4; threads++) {
    tally *tally = tally_create();
    tally->threads = threads;
    polls polls = {.cancel_at = 3}; /* not atomic: only the calling thread polls */
    pl_cancel cancel = {.poll = count_polls, .context = &polls};
    const pl_status status = pl_parallel_for(threads, ITEMS, count_item, tally, &cancel);
    if (threads == 1) { /* with more, the others may be done before the caller's third poll */
      assert_int_equal(status, PL_E_CANCELLED);
      assert_int_equal(atomic_load(&tally->total), 2);
    } else if (polls.count >= polls.cancel_at) {
      assert_int_equal(status, PL_E_CANCELLED);
      assert_true(atomic_load(&cancel.requested));
    } else {
      assert_int_equal(status, PL_OK);
      assert_int_equal(atomic_load(&tally->total), ITEMS);
    }
    free(tally);
  }
}

static pl_status cancel_from_inside(void *context, size_t item, int worker) {
  (void)worker;
  if (item == 10)
    atomic_store(&((pl_cancel *)context)->requested, true);
  return PL_OK;
}

static void work_itself_may_cancel(void **state) {
  (void)state;
  for (int threads = 1; threads <= 4; threads++) {
    pl_cancel cancel = {0};
    assert_int_equal(pl_parallel_for(threads, ITEMS, cancel_from_inside, &cancel, &cancel),
                     PL_E_CANCELLED);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_item_is_done_once),
      cmocka_unit_test(work_of_all_threads_is_the_callers),
      cmocka_unit_test(no_threads_is_a_bad_argument),
      cmocka_unit_test(a_failure_stops_the_rest_and_its_text_arrives),
      cmocka_unit_test(a_token_set_before_lets_nothing_run),
      cmocka_unit_test(the_poll_cancels_from_the_calling_thread),
      cmocka_unit_test(work_itself_may_cancel),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
