/* Tangents for normal maps, similar to MikkTSpace but per vertex.
 *
 * The glTF specification requires MikkTSpace where a file has no tangents. As there, the tangent of
 * a vertex is the sum over its triangles of the direction of increasing u, projected on the plane
 * orthogonal to the normal and weighted by the corner's angle; triangles of opposite handedness do
 * not share vertices. Unlike there, vertices are those of the file: corners with equal position,
 * normal and uv that are separate in the file are not merged. */
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "io/gltf_mesh.hpp"
#include "math/vec.h"

namespace pl_gltf {

namespace {

pl_vec3f vector_at(const std::vector<float> &array, size_t vertex) {
  return {array[3 * vertex], array[3 * vertex + 1], array[3 * vertex + 2]};
}

/* Twice the signed area of a triangle in uv. */
float uv_area(const std::vector<float> &uvs, const uint32_t corner[3]) {
  const size_t a = corner[0], b = corner[1], c = corner[2];
  return (uvs[2 * b] - uvs[2 * a]) * (uvs[2 * c + 1] - uvs[2 * a + 1]) -
         (uvs[2 * c] - uvs[2 * a]) * (uvs[2 * b + 1] - uvs[2 * a + 1]);
}

pl_vec3f reject(pl_vec3f v, pl_vec3f normal) {
  return pl_vec3f_madd(v, -pl_vec3f_dot(v, normal), normal);
}

/* Returns an arbitrary unit vector orthogonal to the normal. */
pl_vec3f across(pl_vec3f n) {
  const pl_vec3f axis = std::fabs(n.x) < 0.6f ? pl_vec3f{1, 0, 0} : pl_vec3f{0, 1, 0};
  return pl_vec3f_unit(reject(axis, n));
}

/* Angle at corner k of a triangle. */
float corner_angle(const Piece &piece, const uint32_t corner[3], int k) {
  const pl_vec3f p = vector_at(piece.positions, corner[k]);
  const pl_vec3f a =
      pl_vec3f_unit(pl_vec3f_sub(vector_at(piece.positions, corner[(k + 1) % 3]), p));
  const pl_vec3f b =
      pl_vec3f_unit(pl_vec3f_sub(vector_at(piece.positions, corner[(k + 2) % 3]), p));
  return std::acos(std::fmin(std::fmax(pl_vec3f_dot(a, b), -1.0f), 1.0f));
}

/* Returns the direction of increasing u on the triangle, not normalised. */
pl_vec3f direction_of_u(const Piece &piece, const std::vector<float> &uvs, const uint32_t c[3],
                        float area) {
  const pl_vec3f p = vector_at(piece.positions, c[0]);
  const pl_vec3f e1 = pl_vec3f_sub(vector_at(piece.positions, c[1]), p);
  const pl_vec3f e2 = pl_vec3f_sub(vector_at(piece.positions, c[2]), p);
  const float dv1 = uvs[2 * c[1] + 1] - uvs[2 * c[0] + 1];
  const float dv2 = uvs[2 * c[2] + 1] - uvs[2 * c[0] + 1];
  const float sign = area < 0.0f ? -1.0f : 1.0f;
  return pl_vec3f_scale(pl_vec3f_sub(pl_vec3f_scale(e1, dv2), pl_vec3f_scale(e2, dv1)), sign);
}

} // namespace

std::vector<uint32_t> split_by_handedness(std::vector<uint32_t> &triangles, size_t vertices,
                                          const std::vector<float> &uvs) {
  std::vector<int8_t> seen(vertices, 0); /* sign of the first triangle with non-zero area in uv */
  std::map<uint32_t, uint32_t> twin;     /* maps a vertex to its copy for the other sign */
  std::vector<uint32_t> added;
  for (size_t t = 0; t + 2 < triangles.size(); t += 3) {
    const float area = uv_area(uvs, &triangles[t]);
    if (!(area < 0.0f) && !(area > 0.0f))
      continue;
    const int8_t sign = area < 0.0f ? -1 : 1;
    for (size_t k = t; k < t + 3; k++) {
      const uint32_t v = triangles[k];
      if (seen[v] == 0)
        seen[v] = sign;
      if (seen[v] == sign)
        continue;
      const auto copy = twin.emplace(v, static_cast<uint32_t>(vertices + added.size()));
      if (copy.second)
        added.push_back(v);
      triangles[k] = copy.first->second;
    }
  }
  return added;
}

void compute_tangents(Piece &piece, int uv_set) {
  const std::vector<float> &uvs = piece.uvs[uv_set];
  std::vector<float> sum(3 * piece.vertices(), 0.0f);
  std::vector<float> hand(piece.vertices(), 1.0f);
  for (size_t t = 0; !uvs.empty() && t + 2 < piece.triangles.size(); t += 3) {
    const uint32_t *c = &piece.triangles[t];
    const float area = uv_area(uvs, c);
    if (!(area < 0.0f) && !(area > 0.0f))
      continue;
    const pl_vec3f u = direction_of_u(piece, uvs, c, area);
    for (int k = 0; k < 3; k++) {
      const pl_vec3f along = pl_vec3f_unit(reject(u, vector_at(piece.normals, c[k])));
      const float weight = corner_angle(piece, c, k);
      sum[3 * c[k]] += weight * along.x;
      sum[3 * c[k] + 1] += weight * along.y;
      sum[3 * c[k] + 2] += weight * along.z;
      /* cross(normal, tangent) * w is the normal map's +y, which is up in the image, opposite to v
       * (glTF 2.0, 3.9.3). On a face whose image is not mirrored, u and v are clockwise: w = 1. */
      hand[c[k]] = area < 0.0f ? 1.0f : -1.0f;
    }
  }
  piece.tangents.resize(4 * piece.vertices());
  for (size_t v = 0; v < piece.vertices(); v++) {
    const pl_vec3f normal = vector_at(piece.normals, v);
    pl_vec3f tangent = pl_vec3f_unit(vector_at(sum, v));
    if (!(pl_vec3f_norm(tangent) > 0.5f))
      tangent = across(normal);
    const float out[4] = {tangent.x, tangent.y, tangent.z, hand[v]};
    std::copy(out, out + 4, &piece.tangents[4 * v]);
  }
}

} // namespace pl_gltf
