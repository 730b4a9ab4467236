/* Makes graph points from triangles and barycentric weights. */
#include "scene/graph_point.h"

#include "scene/shot_frame.h"

pl_graph_point pl_shot_graph_point(const pl_shot_object *object, uint32_t triangle,
                                   const float w[3], pl_vec3f view) {
  const pl_model *model = object->object->model;
  const pl_shot_piece *piece = pl_shot_piece_of(object, triangle);
  const float *to_view = piece != NULL ? piece->to_view : object->to_view;
  const uint32_t *corner = model->indices + 3 * (size_t)triangle;
  const float *a = model->positions + 3 * (size_t)corner[0];
  const pl_triangle_point at = {
      .triangle = triangle,
      .w = {w[0], w[1], w[2]},
      .edge1 = pl_shot_edge(to_view, a, model->positions + 3 * (size_t)corner[1]),
      .edge2 = pl_shot_edge(to_view, a, model->positions + 3 * (size_t)corner[2]),
  };
  pl_vec3f ng = pl_vec3f_across(at.edge1, at.edge2);
  if (piece != NULL)
    ng = pl_vec3f_scale(ng, piece->side);
  pl_surface s;
  pl_shot_frame(object, triangle, w, ng, &s);
  pl_graph_point point = {.t = s.t,
                          .b = s.b,
                          .n = s.n,
                          .ng = ng,
                          .view = view,
                          .filter = PL_FILTER_FINEST,
                          .bumps = true,
                          .random = object->object->materials->random,
                          .model = model,
                          .triangle = at,
                          .offset = object->object->offset,
                          .scale = (float)object->scale};
  point.object = pl_graph_point_object(&point);
  /* First corner relative to the object's origin, then along the edges: avoids cancellation. */
  const pl_vec3 origin =
      piece != NULL ? pl_vec3_sub(piece->origin, object->position)
                    : pl_mat3_mul_vec(object->rotation,
                                      pl_vec3_scale(object->object->offset, -object->scale));
  const float zero[3] = {0.0f, 0.0f, 0.0f};
  const pl_vec3f first = pl_shot_edge(to_view, zero, a);
  point.world = pl_vec3f_add(pl_vec3_to_float(origin), first);
  point.world = pl_vec3f_madd(pl_vec3f_madd(point.world, w[1], at.edge1), w[2], at.edge2);
  return point;
}

bool pl_object_cuts(const pl_object *object) {
  const pl_object_materials *materials = object->materials;
  for (size_t i = 0; materials != NULL && i < materials->count; i++)
    if (pl_graph_cuts(materials->graphs[i].graph))
      return true;
  return false;
}

bool pl_shot_is_there(const pl_shot_object *object, uint32_t triangle, float u, float v,
                      pl_vec3f direction) {
  const pl_object_graph *graph = pl_object_materials_at(object->object->materials, triangle);
  if (graph == NULL || !pl_graph_cuts(graph->graph))
    return true;
  const float w[3] = {1.0f - u - v, u, v};
  const pl_graph_point point =
      pl_shot_graph_point(object, triangle, w, pl_vec3f_scale(direction, -1.0f));
  return pl_graph_is_there(graph->graph, &point, pl_shot_parameters(object, graph));
}
