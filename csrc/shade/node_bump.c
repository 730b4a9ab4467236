/* The normal of a surface displaced by a height. */
#include "shade/node_rows.h"

/* Slopes by central differences over the footprint: what is finer has faded from the height. Near
 * a surface a step of STEP_MIN_M stays above the rounding of positions of a few metres. Blinn,
 * "Simulation of Wrinkled Surfaces", SIGGRAPH 1978: n - dh/dt t - dh/db b. */
static const float STEP_MIN_M = 1e-4f;

static void bump(const pl_node_call *call) {
  const pl_graph_point *p = call->point;
  const float strength = call->in[1][0] * call->in[2][0];
  if (strength == 0.0f || !isfinite(p->radius)) {
    pl_value_vector(call->out[0], p->n, 0.0f);
    return;
  }
  const float step = pl_maxf(p->radius, STEP_MIN_M);
  float height[4];
  for (int i = 0; i < 4; i++) {
    const float side = i & 1 ? step : -step;
    const pl_graph_point at = pl_graph_point_move(p, i < 2 ? side : 0.0f, i < 2 ? 0.0f : side);
    pl_value value;
    pl_node_input_at(call, 0, &at, value);
    height[i] = value[0];
  }
  const float factor = -strength / (2.0f * step);
  pl_vec3f n = pl_vec3f_madd(p->n, factor * (height[1] - height[0]), p->t);
  n = pl_vec3f_madd(n, factor * (height[3] - height[2]), p->b);
  const float length = pl_vec3f_norm(n);
  pl_value_vector(call->out[0], isfinite(length) ? pl_vec3f_unit(n) : p->n, 0.0f);
}

static const pl_socket inputs[] = {
    {"height", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "In units of distance_m"},
    {"distance_m", PL_SCALAR, {0.001f, 0.001f, 0.001f}, "What a height of 1 stands for"},
    {"strength", PL_SCALAR, {1.0f, 1.0f, 1.0f}, "Factor on the slopes; negative: inwards"},
};
static const pl_socket outputs[] = {
    {"normal", PL_VECTOR, {0.0f, 0.0f, 0.0f}, "Unit, for the normal of a surface"}};

const pl_node_kind pl_node_bump = {
    .name = "bump",
    .doc = "The normal of the surface displaced by a height; flat where the footprint is infinite",
    .inputs = inputs,
    .input_count = 3,
    .outputs = outputs,
    .output_count = 1,
    .reads_point = true,
    .lazy = 1u << 0,
    .evaluate = bump,
};
