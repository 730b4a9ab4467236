/* Graphs at points of objects that no shading of a vertex has made: holes, and lamps. */
#ifndef PL_SCENE_GRAPH_POINT_H
#define PL_SCENE_GRAPH_POINT_H

#include "scene/snapshot.h"

/* The point with weights w of a triangle of the object's model, seen by a viewer in the unit
 * direction `view` (root axes). No footprint, all detail. The object has graphs. */
pl_graph_point pl_shot_graph_point(const pl_shot_object *object, uint32_t triangle,
                                   const float w[3], pl_vec3f view);

/* The graph's values in the frame. */
static inline const pl_value *pl_shot_parameters(const pl_shot_object *object,
                                                 const pl_object_graph *graph) {
  return object->parameters != NULL ? object->parameters + graph->first_parameter : NULL;
}

/* Whether an object's graphs can cut holes. */
bool pl_object_cuts(const pl_object *object);
/* Whether graphs leave a surface there; `direction`: of the ray that asks. */
bool pl_shot_is_there(const pl_shot_object *object, uint32_t triangle, float u, float v,
                      pl_vec3f direction);

#endif
