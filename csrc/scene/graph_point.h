/* Evaluates material graphs at points of objects outside of shading: for holes and for emissive
 * surfaces. */
#ifndef PL_SCENE_GRAPH_POINT_H
#define PL_SCENE_GRAPH_POINT_H

#include "scene/snapshot.h"

/* Returns the graph point with barycentric weights w on a triangle of the object's model; `view` is
 * the unit direction to the viewer (root axes). It has no footprint, so patterns have full detail.
 * Precondition: the object has graphs. */
pl_graph_point pl_shot_graph_point(const pl_shot_object *object, uint32_t triangle,
                                   const float w[3], pl_vec3f view);

/* Returns the graph's parameter values in the frame. */
static inline const pl_value *pl_shot_parameters(const pl_shot_object *object,
                                                 const pl_object_graph *graph) {
  return object->parameters != NULL ? object->parameters + graph->first_parameter : NULL;
}

/* Returns whether an object's graphs can cut holes. */
bool pl_object_cuts(const pl_object *object);
/* Returns whether the graphs leave a surface at this point; `direction` is the direction of the
 * ray. */
bool pl_shot_is_there(const pl_shot_object *object, uint32_t triangle, float u, float v,
                      pl_vec3f direction);

#endif
