/* Emissive surfaces in the path integrator: drawn at every vertex and met by chance, both weighted
 * by the power heuristic (Veach 1997). */
#ifndef PL_RENDER_EMITTERS_PATH_H
#define PL_RENDER_EMITTERS_PATH_H

#include "render/path.h"
#include "render/planetshine.h"

/* Weight of the emission of the vertex that path `i` of the wave has met: 1 as seen by the camera;
 * otherwise what chance is worth beside drawing, or 0 where emitters are to light nothing. */
float pl_emitters_met(const pl_path_context *context, const pl_path *path, const pl_ray *ray,
                      const pl_vertex *vertex);

/* Draws a point of an emitter and queues its light at the vertex; what lies between always casts a
 * shadow. `onward`: how the path goes on, and may meet emitters by chance too; NULL: it ends.
 * Returns the new length of the queue. */
size_t pl_emitters_shade(const pl_path_context *context, const pl_path *path,
                         const pl_vertex *vertex, int bounce, pl_vec3f wo,
                         const pl_planetshine_ray *onward, size_t queued, pl_tile_buffers *buffers);

#endif
