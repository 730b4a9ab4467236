/* Weights by the angle between the normal and the viewer. */
#include <math.h>

#include "shade/node_rows.h"
#include "shade/refraction.h"

/* Cosine of the angle between normal and viewer, 0..1. Surfaces are two-sided; a bumped normal that
 * faces away from the viewer gives 0. */
static float facing_of(const pl_node_call *call, size_t lane) {
  const pl_graph_point *p = &call->points[lane];
  const pl_vec3f given = pl_lane_vec(*call->in[1], lane);
  const float length = pl_vec3f_norm(given);
  const bool usable = length > 0.0f && isfinite(length);
  const pl_vec3f n = usable ? pl_vec3f_scale(given, 1.0f / length) : p->n;
  const float side = pl_vec3f_dot(p->ng, p->view) < 0.0f ? -1.0f : 1.0f;
  return pl_minf(pl_maxf(side * pl_vec3f_dot(n, p->view), 0.0f), 1.0f);
}

static void fresnel(const pl_node_call *call) {
  for (size_t i = 0; i < call->count; i++) {
    const float ior = pl_node_number(call, 0, i);
    pl_lane_scalar(call->out[0], i, pl_fresnel(facing_of(call, i), ior > 0.0f ? ior : 0.0f));
  }
  pl_lanes_fill(call->out[0], call->count);
}

static const float BLEND_MAX = 1.0f - 1e-5f;

/* `fresnel` is Fresnel's reflectance for the index 1/(1 - blend). `facing` is 1 - cosine^p, where p
 * is 1 at a blend of 1/2 and tends to 0 and infinity at 0 and 1: the conventions of Blender's Layer
 * Weight node. */
static void layer_weight(const pl_node_call *call) {
  for (size_t i = 0; i < call->count; i++) {
    const float blend = pl_minf(pl_clipped(pl_node_number(call, 0, i), 1.0f), BLEND_MAX);
    const float cosine = facing_of(call, i);
    const float power = blend < 0.5f ? 2.0f * blend : 0.5f / (1.0f - blend);
    pl_lane_scalar(call->out[0], i, pl_fresnel(cosine, 1.0f / (1.0f - blend)));
    pl_lane_scalar(call->out[1], i, 1.0f - powf(cosine, power));
  }
  pl_lanes_fill(call->out[0], call->count);
  pl_lanes_fill(call->out[1], call->count);
}

#define NORMAL_INPUT                                                                               \
  { "normal", PL_VECTOR, {0.0f, 0.0f, 0.0f}, "Of a bump or normal map; the mesh's where zero" }

static const pl_socket fresnel_inputs[] = {
    {"ior", PL_SCALAR, {1.5f, 1.5f, 1.5f}, "Index of refraction, >= 0; 0 counts as infinite"},
    NORMAL_INPUT};
static const pl_socket fresnel_outputs[] = {
    {"factor", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "Part of the light that is mirrored, 0..1"}};

const pl_node_kind pl_node_fresnel = {
    .name = "fresnel",
    .doc = "Light that a smooth dielectric mirrors to the viewer, by Fresnel's equations",
    .inputs = fresnel_inputs,
    .input_count = 2,
    .outputs = fresnel_outputs,
    .output_count = 1,
    .reads_point = true,
    .evaluate = fresnel,
};

static const pl_socket weight_inputs[] = {
    {"blend", PL_SCALAR, {0.5f, 0.5f, 0.5f}, "0..1: towards the centre"}, NORMAL_INPUT};
static const pl_socket weight_outputs[] = {
    {"fresnel", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "As the node fresnel of ior 1 / (1 - blend)"},
    {"facing", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "0 where seen face-on, 1 at the edge"},
};

const pl_node_kind pl_node_layer_weight = {
    .name = "layer_weight",
    .doc = "Weights of layers by how the viewer sees the surface",
    .inputs = weight_inputs,
    .input_count = 2,
    .outputs = weight_outputs,
    .output_count = 2,
    .reads_point = true,
    .evaluate = layer_weight,
};
