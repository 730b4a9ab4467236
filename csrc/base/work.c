/* Counts of what a frame does. */
#include "base/work.h"

_Thread_local pl_work_counts pl_work_done;

static const struct {
  const char *name, *doc;
} rows[PL_WORK_COUNT] = {
#define PL_WORK_ROW(name, doc) {#name, doc},
    PL_WORKS(PL_WORK_ROW)
#undef PL_WORK_ROW
};

const char *pl_work_name(pl_work what) { return rows[what].name; }
const char *pl_work_doc(pl_work what) { return rows[what].doc; }

pl_work_counts pl_work_since(const pl_work_counts *before) {
  pl_work_counts since;
  for (int i = 0; i < PL_WORK_COUNT; i++)
    since.of[i] = pl_work_done.of[i] - before->of[i];
  return since;
}

void pl_work_add_all(const pl_work_counts *counts) {
  for (int i = 0; i < PL_WORK_COUNT; i++)
    pl_work_done.of[i] += counts->of[i];
}
