/* Compares the speed of the tracer with raw Embree calls: for benchmarks/rays.py. */
#ifndef PL_TRACE_MEASURE_H
#define PL_TRACE_MEASURE_H

#include "trace/tracer.h"

typedef struct pl_ray_times {
  size_t rays;
  double ours_s; /* median CPU time of pl_tracer_closest or pl_tracer_occluded over the repeats */
  double raw_s;  /* median time of Embree's packet call alone on the same rays, packed beforehand */
} pl_ray_times;

/* Casts the rays `repeats` times each way, alternating, on one thread. `shadow`: measures occlusion
 * instead of closest hits. */
pl_status pl_tracer_measure(const pl_accelerators *kept, const pl_tracer *tracer,
                            const pl_ray *rays, size_t count, bool shadow, int repeats,
                            pl_ray_times *out);

#endif
