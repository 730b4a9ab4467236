/* Converts primitives to one flattened triangle mesh. Internal to io. */
#ifndef PL_IO_GLTF_MESH_HPP
#define PL_IO_GLTF_MESH_HPP

#include <cmath>
#include <string>
#include <vector>

#include "geom/model.h"
#include "io/gltf_access.hpp"

namespace pl_gltf {

/* Affine node-to-root transform: p' = m p + t, double, file axes (y up). */
struct Affine {
  double m[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  double t[3] = {0, 0, 0};
};

/* Returns the matrix divided by its largest element: transforms directions of nodes of any
 * scale. */
void matrix_of_directions(const Affine &a, double out[3][3]);
double determinant(const double m[3][3]);
Affine compose(const Affine &parent, const Affine &child);
Affine node_transform(const tinygltf::Node &node, size_t index, Warnings &warnings);

/* Bounding box of the geometry that will be rendered, model units (z up). */
struct Extent {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
};

/* Geometry of one primitive of one node, in mesh units (geom/model.h); z-up, vertices numbered from
 * 0. Arrays that a primitive does not have are empty. */
struct Piece {
  std::vector<uint32_t> triangles;                                 /* 3 per triangle */
  std::vector<float> positions, normals, tangents, uvs[2], colors; /* 3, 3, 4, 2, 4 per vertex */
  size_t vertices() const { return positions.size() / 3; }
};

/* Counts over the whole model, for one warning each. */
struct Tally {
  size_t zero_area = 0, not_finite = 0, bad_normals = 0, points = 0, lines = 0;
  size_t unplaced = 0;  /* primitives without POSITION */
  size_t triangles = 0; /* of all pieces, before degenerate ones are removed */
};

/* Mesh attributes that the maps of a primitive's material need. */
struct Needs {
  bool uv_set[2] = {false, false};
  bool tangents = false;
  int tangent_uv_set = 0;
};

/* Grows the extent by the non-degenerate triangles of a primitive. */
void measure_primitive(const Asset &asset, const tinygltf::Primitive &primitive,
                       const std::string &what, const Affine &to_root, Tally &tally,
                       Warnings &warnings, Extent &extent);
/* Reads a primitive; the piece is empty when it has no triangles (points, lines, all degenerate).
 * `model`: its mesh unit and origin must be set, for which every primitive has been measured. */
Piece read_primitive(const Asset &asset, const tinygltf::Primitive &primitive,
                     const std::string &what, const Affine &to_root, const pl_model &model,
                     const Needs &needs, Tally &tally, Warnings &warnings);

/* Splits vertices that are shared by triangles of opposite handedness in uv: triangles of the
 * second kind get new vertices, numbered from `vertices` on. Returns, for each new vertex, the
 * vertex that it copies. */
std::vector<uint32_t> split_by_handedness(std::vector<uint32_t> &triangles, size_t vertices,
                                          const std::vector<float> &uvs);
/* Fills piece.tangents from positions, normals and, if present, uvs (gltf_tangent.cpp). */
void compute_tangents(Piece &piece, int uv_set);

} // namespace pl_gltf

#endif
