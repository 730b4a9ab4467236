/* The normal of a surface displaced by a height. */
#include "shade/node_rows.h"

/* Slopes by central differences over the footprint: what is finer has faded from the height. Near
 * a surface a step of STEP_MIN_M stays above the rounding of positions of a few metres. Blinn,
 * "Simulation of Wrinkled Surfaces", SIGGRAPH 1978: n - dh/dt t - dh/db b.
 *
 * Slopes that have faded still spread what is reflected: see `widen` in graph.c. What they were
 * at the point itself is taken for all of the footprint, so that the mean over hits is right. A
 * lobe that is wider loses nothing to facets that hide each other, a bent normal does: a filtered
 * bump is some hundredths brighter. Where it must not be, points ask for slopes as they are
 * (`pointwise`). */
static const float STEP_MIN_M = 1e-4f;
/* On a body likewise, of the distance from its centre. */
static const float BODY_STEP_MIN = 0x1p-18f;
static const float HIDING = 4.0f; /* steps: a smaller footprint hides nothing */

typedef struct slopes {
  float t, b;
} slopes;

static float least_step(const pl_graph_point *p) {
  return p->body != NULL ? BODY_STEP_MIN * pl_vec3f_norm(p->object) : STEP_MIN_M;
}

static slopes slopes_of(const pl_node_call *call, float radius, float factor) {
  pl_graph_point p = *call->point;
  p.radius = radius;
  const float step = pl_maxf(radius, least_step(&p));
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
  if (!p->bumps || factor == 0.0f) {
    pl_value_vector(call->out[0], p->n, 0.0f);
    return;
  }
  slopes seen = {0.0f, 0.0f};
  const bool pointwise = p->pointwise && isfinite(p->radius);
  if (isfinite(p->radius))
    seen = slopes_of(call, pointwise ? 0.0f : p->radius, factor);
  float hidden = 0.0f;
  if (!pointwise && p->radius > HIDING * least_step(p)) {
    const slopes all = slopes_of(call, 0.0f, factor);
    hidden = (all.t - seen.t) * (all.t - seen.t) + (all.b - seen.b) * (all.b - seen.b);
  }
  const pl_vec3f n = pl_vec3f_madd(pl_vec3f_madd(p->n, -seen.t, p->t), -seen.b, p->b);
  const float length = pl_vec3f_norm(n);
  pl_value_vector(call->out[0], isfinite(length) ? pl_vec3f_unit(n) : p->n,
                  isfinite(hidden) ? hidden : 0.0f);
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
    .doc = "The normal of the surface displaced by a height; slopes that the footprint hides make "
           "the surface rougher",
    .inputs = inputs,
    .input_count = 3,
    .outputs = outputs,
    .output_count = 1,
    .reads_point = true,
    .bends = true,
    .lazy = 1u << 0,
    .evaluate = bump,
};
