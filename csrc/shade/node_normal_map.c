/* Normal maps. */
#include <math.h>

#include "shade/node_rows.h"

enum { UV_SET };
static const float COSINE_MIN = 0.05f; /* normals stay on the surface's side, as in glTF */

/* Tangent along increasing u and bitangent along decreasing v, which is upwards in the image (glTF
 * 2.0, 3.9.3), both perpendicular to the normal; false if the model has no such coordinates or they
 * are degenerate. */
static bool tangents_of(const pl_graph_point *p, int set, pl_vec3f *t, pl_vec3f *b) {
  float uv[3][2], none[2];
  if (p->model == NULL)
    return false;
  for (int k = 0; k < 3; k++) {
    pl_triangle_point corner = p->triangle;
    for (int i = 0; i < 3; i++)
      corner.w[i] = i == k ? 1.0f : 0.0f;
    pl_material_uv(p->model, &corner, set, uv[k], none, none);
  }
  const float u1 = uv[1][0] - uv[0][0], u2 = uv[2][0] - uv[0][0];
  const float v1 = uv[1][1] - uv[0][1], v2 = uv[2][1] - uv[0][1];
  const float area = u1 * v2 - u2 * v1, sign = area < 0.0f ? -1.0f : 1.0f;
  const pl_vec3f u = pl_vec3f_scale(
      pl_vec3f_madd(pl_vec3f_scale(p->triangle.edge1, v2), -v1, p->triangle.edge2), sign);
  const pl_vec3f across = pl_vec3f_madd(u, -pl_vec3f_dot(u, p->n), p->n);
  const float length = pl_vec3f_norm(across);
  if (area == 0.0f || !(length > 0.0f) || !isfinite(length))
    return false;
  /* Unless the image is mirrored, u and v turn clockwise on a face. A mirroring transform of the
   * object mirrors the image, too: hence the winding of the triangle decides, not the side of the
   * normal. */
  const pl_vec3f outwards = pl_vec3f_cross(p->triangle.edge1, p->triangle.edge2);
  const bool flipped = pl_vec3f_dot(outwards, p->n) < 0.0f;
  *t = pl_vec3f_scale(across, 1.0f / length);
  *b = pl_vec3f_scale(pl_vec3f_cross(p->n, *t), (area < 0.0f) != flipped ? 1.0f : -1.0f);
  return true;
}

static pl_vec3f normal_at(const pl_graph_point *p, int set, pl_vec3f color, float strength) {
  pl_vec3f t = p->t, b = p->b;
  if (!p->bumps || isinf(p->radius) || strength == 0.0f)
    return p->n;
  const bool of_file = set == 0 && p->model != NULL && p->model->tangents != NULL;
  if (!of_file)
    tangents_of(p, set, &t, &b);
  const float x = strength * (2.0f * color.x - 1.0f), y = strength * (2.0f * color.y - 1.0f);
  const float z = pl_maxf(2.0f * color.z - 1.0f, COSINE_MIN);
  const pl_vec3f n = pl_vec3f_madd(pl_vec3f_madd(pl_vec3f_scale(t, x), y, b), z, p->n);
  const float length = pl_vec3f_norm(n);
  return length > 0.0f && isfinite(length) ? pl_vec3f_scale(n, 1.0f / length) : p->n;
}

static void normal_map(const pl_node_call *call) {
  const int set = (int)call->constants[UV_SET].number;
  for (size_t i = 0; i < call->count; i++)
    pl_lane_vector(
        call->out[0], i,
        normal_at(&call->points[i], set, pl_lane_vec(*call->in[0], i), pl_node_number(call, 1, i)),
        0.0f);
  pl_lanes_fill(call->out[0], call->count);
}

static const char *const sets[] = {"uv", "uv1", NULL};
static const pl_constant_row constants[] = {
    [UV_SET] = {"uv", PL_CHOICE, 0, 0, 0, sets, 0,
                "Texture coordinates along which the normals are given; where the model has none "
                "they are along the axes that its materials use"}};
static const pl_socket inputs[] = {
    {"color",
     PL_COLOR,
     {0.5f, 0.5f, 1.0f},
     "Of an image in color_space linear: normal = 2 color - 1, x to the right, y up in the image, "
     "z outwards (as glTF and OpenGL)"},
    {"strength", PL_SCALAR, {1.0f, 1.0f, 1.0f}, "Factor on x and y; negative: inwards"},
};
static const pl_socket outputs[] = {
    {"normal", PL_VECTOR, {0.0f, 0.0f, 0.0f}, "Unit, for the normal of a surface"}};

const pl_node_kind pl_node_normal_map = {
    .name = "normal_map",
    .doc = "The normal that a picture gives in tangent space; flat where the footprint is infinite",
    .inputs = inputs,
    .input_count = 2,
    .outputs = outputs,
    .output_count = 1,
    .constants = constants,
    .constant_count = 1,
    .reads_point = true,
    .bends = true,
    .evaluate = normal_map,
};
