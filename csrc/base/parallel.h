/* Parallel for loop over pthreads. Threads are spawned and joined in each call; there is no thread
 * pool and no global state. */
#ifndef PL_BASE_PARALLEL_H
#define PL_BASE_PARALLEL_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

/* Cancel token. Any thread may set `requested` to stop the work soon. `poll`, if given, is called
 * on the calling thread between items and returns true to cancel (it may take locks, run signal
 * handlers, report progress). */
typedef struct pl_cancel {
  atomic_bool requested;
  bool (*poll)(void *context);
  void *context;
} pl_cancel;

/* Processes one item. `worker` is in [0, threads) and identifies scratch memory. */
typedef pl_status (*pl_item_fn)(void *context, size_t item, int worker);

/* Runs `work` for items 0..count-1 on `threads` threads (the caller is one of them). Items are
 * handed out in order. The first failure (the lowest item among the observed failures) stops the
 * rest; its text becomes the caller's error text. `cancel` may be NULL. If some threads cannot be
 * spawned, the others do the work. */
pl_status pl_parallel_for(int threads, size_t count, pl_item_fn work, void *context,
                          pl_cancel *cancel);

#endif
