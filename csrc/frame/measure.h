/* The rays of a real frame, timed: for benchmarks/rays.py. */
#ifndef PL_FRAME_MEASURE_H
#define PL_FRAME_MEASURE_H

#include "frame/frame.h"
#include "trace/measure.h"

/* Primary rays of all pixels that may see a mesh, tile by tile, and shadow rays from what they hit
 * to the middle of the sun. One thread; only the placement of the request is read. */
pl_status pl_measure_rays(const pl_scene *scene, const pl_placement *placement, int repeats,
                          pl_ray_times *primary, pl_ray_times *shadow);

#endif
