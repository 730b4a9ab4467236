/* Times the rays of a real frame: for benchmarks/rays.py and scan.py. */
#ifndef PL_FRAME_MEASURE_H
#define PL_FRAME_MEASURE_H

#include "frame/frame.h"
#include "scene/ray_source.h"
#include "trace/measure.h"

/* Times primary rays of all pixels that may see a mesh, tile by tile, and shadow rays from their
 * hits to the centre of the sun. One thread; of the request only the placement is used. */
pl_status pl_measure_rays(const pl_scene *scene, const pl_placement *placement, int repeats,
                          pl_ray_times *primary, pl_ray_times *shadow);
/* Renders the frame on one thread, and casts its rays at meshes and terrain again to time them,
 * metering and sub-pixel bodies included: rays to closest hits, and rays to lights. */
pl_status pl_measure_frame(pl_renderer *renderer, const pl_frame_request *request, int repeats,
                           pl_ray_times *closest, pl_ray_times *shadow);
/* Times all rays of a source, in the order of its beams, from where the camera of the placement is
 * at the middle of its exposure. One thread. */
pl_status pl_measure_scan(const pl_scene *scene, const pl_placement *placement,
                          const pl_ray_source *source, int repeats, pl_ray_times *out);

#endif
