/* What graphs on objects emit, as lights see it. */
#ifndef PL_LIGHT_GRAPH_LIGHT_H
#define PL_LIGHT_GRAPH_LIGHT_H

#include "scene/snapshot.h"

/* Mean luminance of what the graph emits on a triangle, near enough for choosing it: above 0 where
 * anything is found. The means of patterns alone tell of what is found in none of a few places. */
float pl_graph_light_luminance(const pl_shot_object *object, uint32_t triangle,
                               const pl_object_graph *graph, pl_detail detail);

/* What it emits from the point with weights w to a viewer in the unit direction `view`. */
pl_vec3f pl_graph_light_radiance(const pl_shot_object *object, uint32_t triangle, const float w[3],
                                 const pl_object_graph *graph, pl_detail detail, pl_vec3f view);

#endif
