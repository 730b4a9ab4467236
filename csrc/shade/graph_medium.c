/* Evaluates a graph's surface inputs as properties of a participating medium. */
#include "shade/graph_medium.h"

#include "shade/node_rows.h"

static pl_vec3f cut3(const float *v, float factor, float high) {
  return pl_vec3f_make(pl_clipped(factor * v[0], high), pl_clipped(factor * v[1], high),
                       pl_clipped(factor * v[2], high));
}

float pl_graph_density(const pl_graph *graph, const pl_graph_point *point, const pl_value *params) {
  return pl_clipped(pl_graph_alpha(graph, point, params), 1.0f);
}

pl_medium pl_graph_medium(const pl_graph *graph, const pl_graph_point *point,
                          const pl_value *params) {
  pl_value v[PL_NODE_SOCKETS];
  pl_graph_evaluate(graph, point, params, v);
  pl_medium out = {.density = pl_clipped(v[PL_SURFACE_ALPHA][0], 1.0f),
                   .albedo = cut3(v[PL_SURFACE_BASE_COLOR], 1.0f, 1.0f)};
  if (pl_graph_emits(graph))
    out.emission = cut3(v[PL_SURFACE_EMISSION_COLOR], v[PL_SURFACE_EMISSION_STRENGTH][0],
                        (float)PL_EMISSION_MAX);
  return out;
}

double pl_graph_medium_emission_max(const pl_graph *graph) {
  pl_model_summary summary = {0};
  pl_graph_summarise(graph, &summary);
  return pl_graph_emits(graph) ? summary.emission_max : 0.0;
}
