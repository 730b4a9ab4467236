/* Worker threads claim items from one atomic counter. Results must not depend on which worker
 * claims which item. */
#include "base/parallel.h"

#include <pthread.h>
#include <stdio.h>

#include "base/work.h"

enum { MAX_THREADS = 256 };

typedef struct job {
  pl_item_fn work;
  void *context;
  size_t count;
  atomic_size_t next;
  atomic_bool stop;
  pl_cancel *cancel;
  pthread_mutex_t lock; /* guards the three fields below */
  pl_status status;
  size_t failed_item;
  char text[1024];
} job;

typedef struct worker {
  job *job;
  int index;
  pthread_t thread;
  pl_work_counts work; /* of a thread that was spawned */
} worker;

static void record_failure(job *job, size_t item, pl_status status) {
  pthread_mutex_lock(&job->lock);
  if (job->status == PL_OK || item < job->failed_item) {
    job->status = status;
    job->failed_item = item;
    snprintf(job->text, sizeof job->text, "%s", pl_error_text());
  }
  pthread_mutex_unlock(&job->lock);
  atomic_store(&job->stop, true);
}

static bool cancelled(job *job, int worker) {
  if (job->cancel == NULL)
    return false;
  if (worker == 0 && job->cancel->poll != NULL && job->cancel->poll(job->cancel->context))
    atomic_store(&job->cancel->requested, true);
  return atomic_load(&job->cancel->requested);
}

static void *run(void *argument) {
  worker *self = argument;
  job *job = self->job;
  while (!atomic_load(&job->stop)) {
    if (cancelled(job, self->index))
      break;
    const size_t item = atomic_fetch_add(&job->next, 1);
    if (item >= job->count)
      break;
    const pl_status status = job->work(job->context, item, self->index);
    if (status != PL_OK)
      record_failure(job, item, status);
  }
  if (self->index > 0)
    self->work = pl_work_done; /* all that this thread ever did */
  return NULL;
}

pl_status pl_parallel_for(int threads, size_t count, pl_item_fn work, void *context,
                          pl_cancel *cancel) {
  job job = {.work = work, .context = context, .count = count, .cancel = cancel};
  worker workers[MAX_THREADS];
  int spawned = 1;
  if (threads > MAX_THREADS)
    threads = MAX_THREADS;
  if (threads < 1)
    return pl_fail(PL_E_ARGUMENT, "threads must be at least 1, not %d", threads);
  pthread_mutex_init(&job.lock, NULL);
  for (int i = 1; i < threads && (size_t)i < count; i++) {
    workers[spawned] = (worker){.job = &job, .index = spawned};
    if (pthread_create(&workers[spawned].thread, NULL, run, &workers[spawned]) == 0)
      spawned++;
  }
  workers[0] = (worker){.job = &job, .index = 0};
  run(&workers[0]);
  for (int i = 1; i < spawned; i++) {
    pthread_join(workers[i].thread, NULL);
    pl_work_add_all(&workers[i].work);
  }
  pthread_mutex_destroy(&job.lock);
  if (job.status != PL_OK)
    return pl_fail(job.status, "%s", job.text);
  if (cancel != NULL && atomic_load(&cancel->requested))
    return pl_fail(PL_E_CANCELLED, "cancelled");
  return PL_OK;
}
