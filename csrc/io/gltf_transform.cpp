/* Transforms of nodes (glTF 2.0, section 3.5.3). */
#include <cmath>

#include "io/gltf_mesh.hpp"

namespace pl_gltf {

namespace {

/* Largest deviation of a quaternion from unit length without a warning; floats written with a few
 * digits are within it. */
constexpr double UNIT_TOLERANCE = 1e-3;

Affine from_matrix(const std::vector<double> &m, size_t index) { /* column major */
  if (m[3] != 0.0 || m[7] != 0.0 || m[11] != 0.0 || m[15] != 1.0)
    fail(PL_E_FORMAT, "nodes[%zu].matrix: the last row must be 0, 0, 0, 1", index);
  Affine a;
  for (size_t row = 0; row < 3; row++) {
    for (size_t column = 0; column < 3; column++)
      a.m[row][column] = m[4 * column + row];
    a.t[row] = m[12 + row];
  }
  return a;
}

void rotate(Affine &a, const std::vector<double> &q, size_t index, Warnings &warnings) {
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(norm > 0.0) || !std::isfinite(norm))
    fail(PL_E_FORMAT, "nodes[%zu].rotation: a quaternion of length %g is no rotation", index, norm);
  if (std::fabs(norm - 1.0) > UNIT_TOLERANCE)
    warnings.add("nodes[%zu].rotation has length %g and is normalised", index, norm);
  const double x = q[0] / norm, y = q[1] / norm, z = q[2] / norm, w = q[3] / norm;
  const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                          {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                          {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      a.m[i][j] = r[i][j];
}

} // namespace

void matrix_of_directions(const Affine &a, double out[3][3]) {
  double most = 0.0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      most = std::fmax(most, std::fabs(a.m[i][j]));
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      out[i][j] = most > 0.0 ? a.m[i][j] / most : 0.0;
}

double determinant(const double m[3][3]) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

Affine compose(const Affine &parent, const Affine &child) {
  Affine out;
  for (int i = 0; i < 3; i++) {
    out.t[i] = parent.t[i];
    for (int j = 0; j < 3; j++) {
      out.t[i] += parent.m[i][j] * child.t[j];
      out.m[i][j] = 0.0;
      for (int k = 0; k < 3; k++)
        out.m[i][j] += parent.m[i][k] * child.m[k][j];
    }
  }
  return out;
}

Affine node_transform(const tinygltf::Node &node, size_t index, Warnings &warnings) {
  if (node.matrix.size() == 16)
    return from_matrix(node.matrix, index);
  Affine a;
  if (node.rotation.size() == 4)
    rotate(a, node.rotation, index, warnings);
  for (size_t j = 0; j < 3; j++) {
    if (node.translation.size() == 3)
      a.t[j] = node.translation[j];
    for (size_t i = 0; i < 3 && node.scale.size() == 3; i++)
      a.m[i][j] *= node.scale[j];
  }
  return a;
}

} // namespace pl_gltf
