/* Node `model_material`: values of the object's own material at the point. */
#include <math.h>

#include "shade/node_rows.h"

enum { BASE_COLOR, METALLIC, ROUGHNESS, EMISSION = PL_OWN_EMISSION, NORMAL, OPACITY };

static void put(const pl_surface *s, float opacity, pl_lanes *out, size_t i) {
  pl_lane_vector(out[BASE_COLOR], i, s->color, 0.0f);
  pl_lane_scalar(out[METALLIC], i, s->metallic);
  pl_lane_scalar(out[ROUGHNESS], i, sqrtf(s->alpha));
  pl_lane_vector(out[EMISSION], i, s->emission, 0.0f);
  pl_lane_vector(out[NORMAL], i, s->n, 0.0f);
  pl_lane_scalar(out[OPACITY], i, opacity);
}

/* The body's map times its albedo. */
static void body_surface(const pl_graph_point *p, pl_surface *s) {
  float map[4] = {1.0f, 1.0f, 1.0f, 1.0f}, uv[2], a[2], b[2];
  const float *albedo = p->body_albedo, *emission = p->body_emission;
  if (p->body_map != NULL && isinf(p->radius)) {
    pl_texture_mean(p->body_map, map);
  } else if (p->body_map != NULL) {
    pl_graph_point_uv(p, 0, uv, a, b);
    pl_texture_sample(p->body_map, uv[0], uv[1], a, b, p->filter, map);
  }
  s->color = pl_vec3f_make(pl_minf(map[0] * albedo[0], 1.0f), pl_minf(map[1] * albedo[1], 1.0f),
                           pl_minf(map[2] * albedo[2], 1.0f));
  s->emission = pl_vec3f_make(emission[0], emission[1], emission[2]);
}

static void own_at(const pl_graph_point *p, pl_lanes *out, size_t i) {
  const pl_detail detail = {.maps = !isinf(p->radius), .bumps = p->bumps, .filter = p->filter};
  pl_surface s = {.t = p->t, .b = p->b, .n = p->n, .ng = p->ng, .alpha = 1.0f};
  float opacity = 1.0f;
  if (p->body != NULL) {
    body_surface(p, &s);
  } else if (p->model != NULL) {
    pl_material_surface(p->model, &p->triangle, detail, &s);
    opacity = pl_material_opacity(p->model, &p->triangle);
  }
  put(&s, opacity, out, i);
}

static void own(const pl_node_call *call) {
  for (size_t i = 0; i < call->count; i++)
    own_at(&call->points[i], call->out, i);
  for (size_t k = 0; k <= OPACITY; k++)
    pl_lanes_fill(call->out[k], call->count);
}

static const pl_socket outputs[] = {
    [BASE_COLOR] = {"base_color", PL_COLOR, {0.0f, 0.0f, 0.0f}, "Linear RGB"},
    [METALLIC] = {"metallic", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "0..1"},
    [ROUGHNESS] = {"roughness", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "0..1"},
    [EMISSION] = {"emission", PL_COLOR, {0.0f, 0.0f, 0.0f}, "Radiance, W m-2 sr-1 in each band"},
    [NORMAL] = {"normal", PL_VECTOR, {0.0f, 0.0f, 0.0f}, "Unit, by the normal map"},
    [OPACITY] = {"opacity", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "0..1; of alphaMode MASK 0 or 1"},
};

const pl_node_kind pl_node_model_material = {
    .name = "model_material",
    .doc = "What the model's own material gives, with its maps, or a body's own map and albedo",
    .outputs = outputs,
    .output_count = sizeof outputs / sizeof outputs[0],
    .reads_point = true,
    .reads_own = true,
    .evaluate = own,
};
