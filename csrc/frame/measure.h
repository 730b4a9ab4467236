/* Times the rays of a real frame: for benchmarks/rays.py. */
#ifndef PL_FRAME_MEASURE_H
#define PL_FRAME_MEASURE_H

#include "frame/frame.h"
#include "trace/measure.h"

/* Times primary rays of all pixels that may see a mesh, tile by tile, and shadow rays from their
 * hits to the centre of the sun. One thread; of the request only the placement is used. */
pl_status pl_measure_rays(const pl_scene *scene, const pl_placement *placement, int repeats,
                          pl_ray_times *primary, pl_ray_times *shadow);

#endif
