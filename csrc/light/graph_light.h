/* Emission of graphs on objects, for light sampling. */
#ifndef PL_LIGHT_GRAPH_LIGHT_H
#define PL_LIGHT_GRAPH_LIGHT_H

#include "scene/snapshot.h"

/* Estimated mean luminance of a graph's emission on a triangle, accurate enough for light
 * selection; above 0 where any emission was found. Emission that none of the few sampled points
 * shows is represented only by the means of the graph's patterns. */
float pl_graph_light_luminance(const pl_shot_object *object, uint32_t triangle,
                               const pl_object_graph *graph, pl_detail detail);

/* Radiance that the graph emits at the point with barycentric weights w towards a viewer in the
 * unit direction `view`. */
pl_vec3f pl_graph_light_radiance(const pl_shot_object *object, uint32_t triangle, const float w[3],
                                 const pl_object_graph *graph, pl_detail detail, pl_vec3f view);

#endif
