/* Emissive surfaces in the path integrator. They are sampled at every vertex and also hit by BSDF
 * sampling; both are weighted by the power heuristic (Veach 1997). */
#ifndef PL_RENDER_EMITTERS_PATH_H
#define PL_RENDER_EMITTERS_PATH_H

#include "render/path.h"
#include "render/planetshine.h"

/* Weight of the emission of the vertex that the path's ray has hit: 1 for camera rays; otherwise
 * the weight of BSDF sampling against next-event estimation, or 0 if emitters are to light nothing.
 */
float pl_emitters_met(const pl_path_context *context, const pl_path *path, const pl_ray *ray,
                      const pl_vertex *vertex);

/* Samples a point of an emitter and queues its light at the vertex with a shadow ray. Anything in
 * between occludes it. `onward`: how the path's next direction is sampled, which may hit emitters
 * too; NULL if the path ends here. Returns the new length of the queue. */
size_t pl_emitters_shade(const pl_path_context *context, const pl_path *path,
                         const pl_vertex *vertex, int bounce, pl_vec3f wo,
                         const pl_planetshine_ray *onward, size_t queued, pl_tile_buffers *buffers);

#endif
