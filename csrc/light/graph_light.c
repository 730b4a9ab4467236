/* Emission of graphs at points on triangles, and its mean over a triangle. */
#include "light/graph_light.h"

#include "math/color.h"
#include "scene/graph_point.h"

/* Lower bound of the estimate as a fraction of the pattern's mean, used if the sampled points emit
 * nothing. */
static const float MEAN_MIN = 1e-3f;
enum { PLACES = 4 };

static pl_vec3f emission_at(const pl_shot_object *object, const pl_object_graph *graph,
                            const pl_graph_point *point) {
  return pl_graph_emission(graph->graph, point, pl_shot_parameters(object, graph));
}

pl_vec3f pl_graph_light_radiance(const pl_shot_object *object, uint32_t triangle, const float w[3],
                                 const pl_object_graph *graph, pl_detail detail, pl_vec3f view) {
  pl_graph_point point = pl_shot_graph_point(object, triangle, w, view);
  point.filter = detail.filter;
  point.bumps = detail.bumps;
  point.radius = detail.maps ? 0.0f : INFINITY;
  return emission_at(object, graph, &point);
}

/* Mean over the centroids of the four triangles that result from bisecting the edges, each with its
 * footprint. The central one is viewed along the normal, the others obliquely from three sides. */
static float mean_of_places(const pl_shot_object *object, uint32_t triangle,
                            const pl_object_graph *graph, pl_detail detail) {
  static const float w[PLACES][3] = {{1.0f / 3.0f, 1.0f / 3.0f, 1.0f / 3.0f},
                                     {2.0f / 3.0f, 1.0f / 6.0f, 1.0f / 6.0f},
                                     {1.0f / 6.0f, 2.0f / 3.0f, 1.0f / 6.0f},
                                     {1.0f / 6.0f, 1.0f / 6.0f, 2.0f / 3.0f}};
  static const float aslant[PLACES][2] = {
      {0.0f, 0.0f}, {1.0f, 0.0f}, {-0.5f, 0.9f}, {-0.5f, -0.9f}};
  float sum = 0.0f;
  for (int i = 0; i < PLACES; i++) {
    pl_graph_point p = pl_shot_graph_point(object, triangle, w[i], pl_vec3f_make(0, 0, 0));
    const pl_vec3f e1 = p.triangle.edge1, e2 = p.triangle.edge2;
    p.view =
        pl_vec3f_unit(pl_vec3f_madd(pl_vec3f_madd(p.ng, aslant[i][0], p.t), aslant[i][1], p.b));
    p.triangle.footprint_a = pl_vec3f_scale(e1, 0.5f);
    p.triangle.footprint_b = pl_vec3f_scale(e2, 0.5f);
    p.radius = sqrtf(pl_vec3f_norm(pl_vec3f_cross(e1, e2)) / (8.0f * PL_PI_F));
    p.filter = detail.filter;
    p.bumps = detail.bumps;
    sum += pl_luminance(emission_at(object, graph, &p));
  }
  return sum / (float)PLACES;
}

float pl_graph_light_luminance(const pl_shot_object *object, uint32_t triangle,
                               const pl_object_graph *graph, pl_detail detail) {
  static const float middle[3] = {1.0f / 3.0f, 1.0f / 3.0f, 1.0f / 3.0f};
  pl_graph_point point = {.radius = INFINITY};
  if (!pl_graph_emits_evenly(graph->graph)) {
    point = pl_shot_graph_point(object, triangle, middle, pl_vec3f_make(0, 0, 0));
    point.view = point.ng;
    point.radius = INFINITY;
  }
  const float mean = pl_luminance(emission_at(object, graph, &point));
  if (!detail.maps || pl_graph_emits_evenly(graph->graph))
    return mean;
  return pl_maxf(mean_of_places(object, triangle, graph, detail), MEAN_MIN * mean);
}
