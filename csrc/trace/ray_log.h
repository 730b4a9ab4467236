/* The rays that a frame casts at meshes and terrain, kept to be cast again: for benchmarks. */
#ifndef PL_TRACE_RAY_LOG_H
#define PL_TRACE_RAY_LOG_H

#include "trace/tracer.h"

enum { PL_LOG_CLOSEST, PL_LOG_SHADOW, PL_LOG_KINDS };

typedef struct pl_ray_log {
  pl_ray *rays[PL_LOG_KINDS]; /* owned; in the order in which they were cast */
  size_t count[PL_LOG_KINDS], room[PL_LOG_KINDS];
  bool full; /* memory ran out, and rays are missing */
} pl_ray_log;

/* Tracers that are built from now on add the rays that they cast, until this is called with NULL.
 * For frames of one thread alone: a log has no lock. */
void pl_accelerators_log(pl_accelerators *kept, pl_ray_log *log);
/* Adds rays of one kind, but those that skip meshes. */
void pl_ray_log_add(pl_ray_log *log, int kind, const pl_ray *rays, size_t count);
void pl_ray_log_clear(pl_ray_log *log);

#endif
