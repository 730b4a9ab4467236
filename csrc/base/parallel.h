/* Parallel-for over pthreads: threads are spawned per call and joined; no pool, no global state. */
#ifndef PL_BASE_PARALLEL_H
#define PL_BASE_PARALLEL_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

/* Set by anyone to stop work soon. `poll`, if given, is called on the calling thread between
 * items and returns true to cancel (it may take locks, run signal handlers, report progress). */
typedef struct pl_cancel {
  atomic_bool requested;
  bool (*poll)(void *context);
  void *context;
} pl_cancel;

/* Work on one item. `worker` is in [0, threads) and identifies scratch memory. */
typedef pl_status (*pl_item_fn)(void *context, size_t item, int worker);

/* Runs `work` for items 0..count-1 on `threads` threads (the caller is one of them). Items are
 * handed out in order. The first failure (lowest item among those seen) stops the rest; its text
 * becomes the caller's error text. `cancel` may be NULL. If threads cannot be spawned the work is
 * done by those that could. */
pl_status pl_parallel_for(int threads, size_t count, pl_item_fn work, void *context,
                          pl_cancel *cancel);

#endif
