/* Bump mapping: the normal of a surface displaced by a height. */
#include "shade/node_rows.h"

/* Slopes at the point by central differences over a small step. STEP_MIN_M is above the rounding
 * errors of positions of a few metres. The normal is n - dh/dt t - dh/db b (Blinn, "Simulation of
 * Wrinkled Surfaces", SIGGRAPH 1978).
 *
 * Slopes are not filtered by the footprint: Monte Carlo samples average over the pixel. A lobe
 * widened by the variance of the hidden slopes is not the mean over the bumped normals: it is
 * brighter, by up to several times at grazing incidence, and for bumps finer than the footprint of
 * a sample more samples would not correct that. */
static const float STEP_MIN_M = 1e-4f;
/* The same on a body, relative to the distance from its centre. */
static const float BODY_STEP_MIN = 0x1p-18f;

typedef struct slopes {
  float t, b;
} slopes;

static float least_step(const pl_graph_point *p) {
  return p->body != NULL ? BODY_STEP_MIN * pl_vec3f_norm(p->object) : STEP_MIN_M;
}

static slopes slopes_of(const pl_node_call *call, float factor) {
  pl_graph_point p = *call->point;
  p.radius = 0.0f;
  const float step = least_step(&p);
  float height[4];
  for (int i = 0; i < 4; i++) {
    const float side = i & 1 ? step : -step;
    const pl_graph_point at = pl_graph_point_move(&p, i < 2 ? side : 0.0f, i < 2 ? 0.0f : side);
    pl_value value;
    pl_node_input_at(call, 0, &at, value);
    height[i] = value[0];
  }
  const slopes s = {factor * (height[1] - height[0]) / (2.0f * step),
                    factor * (height[3] - height[2]) / (2.0f * step)};
  return isfinite(s.t) && isfinite(s.b) ? s : (slopes){0.0f, 0.0f};
}

static void bump(const pl_node_call *call) {
  const pl_graph_point *p = call->point;
  const float factor = call->in[1][0] * call->in[2][0];
  if (!p->bumps || factor == 0.0f || !isfinite(p->radius)) {
    pl_value_vector(call->out[0], p->n, 0.0f);
    return;
  }
  const slopes seen = slopes_of(call, factor);
  const pl_vec3f n = pl_vec3f_madd(pl_vec3f_madd(p->n, -seen.t, p->t), -seen.b, p->b);
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
    .doc = "The normal of the surface displaced by a height, at the point itself",
    .inputs = inputs,
    .input_count = 3,
    .outputs = outputs,
    .output_count = 1,
    .reads_point = true,
    .bends = true,
    .lazy = 1u << 0,
    .evaluate = bump,
};
