/* Bump mapping: the normal of a surface displaced by a height. */
#include "shade/node_rows.h"

/* Slopes at the point are derivatives of the height, where all of its nodes have them. Otherwise,
 * with steps and images, they are central differences over a small step, which also shows steps as
 * narrow slopes. STEP_MIN_M is above the rounding errors of positions of a few metres. The normal
 * is n - dh/dt t - dh/db b (Blinn, "Simulation of Wrinkled Surfaces", SIGGRAPH 1978).
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

enum { SIDES = 4 }; /* points at which a slope needs heights: towards -t, t, -b, b */

static pl_graph_point beside(const pl_graph_point *point, float step, size_t side) {
  const float by = side & 1u ? step : -step;
  return pl_graph_point_move(point, side < 2 ? by : 0.0f, side < 2 ? 0.0f : by);
}

/* Heights beside the points of `lanes`, in as few batches as they fill. */
static void heights_of(const pl_node_call *call, const size_t *lanes, size_t count,
                       const float *step, float height[][SIDES]) {
  pl_graph_point at[PL_LANES];
  pl_lanes value;
  for (size_t done = 0; done < SIDES * count; done += PL_LANES) {
    const size_t size = SIDES * count - done < PL_LANES ? SIDES * count - done : PL_LANES;
    for (size_t i = 0; i < size; i++) {
      const size_t k = (done + i) / SIDES;
      at[i] = beside(&call->points[lanes[k]], step[k], (done + i) % SIDES);
      at[i].radius = 0.0f;
    }
    pl_node_input_at(call, 0, at, size, value);
    for (size_t i = 0; i < size; i++)
      height[(done + i) / SIDES][(done + i) % SIDES] = value[0][i];
  }
}

/* Slopes at the points of `lanes` from heights beside them. */
static void differences_of(const pl_node_call *call, const size_t *lanes, size_t count,
                           slopes out[PL_LANES]) {
  float step[PL_LANES] = {0.0f}, height[PL_LANES][SIDES];
  for (size_t k = 0; k < count; k++)
    step[k] = least_step(&call->points[lanes[k]]);
  heights_of(call, lanes, count, step, height);
  for (size_t k = 0; k < count; k++)
    out[k] = (slopes){(height[k][1] - height[k][0]) / (2.0f * step[k]),
                      (height[k][3] - height[k][2]) / (2.0f * step[k])};
}

/* The derivatives at the points of `lanes`. */
static void derivatives_of(const pl_node_call *call, const size_t *lanes, size_t count,
                           slopes out[PL_LANES]) {
  pl_graph_point at[PL_LANES];
  float slope[2][PL_LANES];
  for (size_t k = 0; k < count; k++) {
    at[k] = call->points[lanes[k]];
    at[k].radius = 0.0f;
  }
  if (count > 0)
    pl_node_input_slopes(call, 0, at, count, slope);
  for (size_t k = 0; k < count; k++)
    out[k] = (slopes){slope[0][k], slope[1][k]};
}

/* The normal at a point from the slopes of the height. */
static pl_vec3f normal_of(const pl_graph_point *p, slopes of_height, float factor) {
  slopes s = {factor * of_height.t, factor * of_height.b};
  if (!isfinite(s.t) || !isfinite(s.b))
    s = (slopes){0.0f, 0.0f};
  const pl_vec3f n = pl_vec3f_madd(pl_vec3f_madd(p->n, -s.t, p->t), -s.b, p->b);
  return isfinite(pl_vec3f_norm(n)) ? pl_vec3f_unit(n) : p->n;
}

static void bump(const pl_node_call *call) {
  size_t bumped[PL_LANES] = {0}, count = 0;
  float factor[PL_LANES];
  slopes slope[PL_LANES];
  for (size_t i = 0; i < call->count; i++) {
    const pl_graph_point *p = &call->points[i];
    const float by = pl_node_number(call, 1, i) * pl_node_number(call, 2, i);
    pl_lane_vector(call->out[0], i, p->n, 0.0f);
    if (!p->bumps || by == 0.0f || !isfinite(p->radius))
      continue;
    bumped[count] = i;
    factor[count++] = by;
  }
  if (pl_node_input_has_slopes(call, 0))
    derivatives_of(call, bumped, count, slope);
  else
    differences_of(call, bumped, count, slope);
  for (size_t k = 0; k < count; k++) {
    const pl_graph_point *p = &call->points[bumped[k]];
    pl_lane_vector(call->out[0], bumped[k], normal_of(p, slope[k], factor[k]), 0.0f);
  }
  pl_lanes_fill(call->out[0], call->count);
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
