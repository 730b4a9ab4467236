/* Reads one primitive: triangles of any mode, vertices, normals (glTF 2.0, section 3.7.2). */
#include "io/gltf_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

namespace pl_gltf {

namespace {

/* The direction of a shorter normal is lost in rounding. */
constexpr double SHORTEST_NORMAL = 1e-6;
/* Limit on triangles by the size of a file: this many for any file, plus one per byte. (Nodes may
 * share a mesh, so there can be more triangles than the bytes could hold.) */
constexpr size_t FREE_TRIANGLES = size_t{1} << 20;
constexpr uint32_t NONE = UINT32_MAX;
/* Upper bound of coordinates of a mesh, in mesh units. */
constexpr float OUTERMOST = 4.0f;

struct Vec {
  double x = 0, y = 0, z = 0;
};
Vec operator-(const Vec &a, const Vec &b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec cross(const Vec &a, const Vec &b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double norm(const Vec &a) { return std::sqrt(a.x * a.x + a.y * a.y + a.z * a.z); }

/* Converts one primitive to a piece. */
class Builder {
public:
  Builder(const Asset &asset, const tinygltf::Primitive &primitive, const std::string &what,
          const Affine &to_root, Tally &tally, Warnings &warnings)
      : asset_(asset), primitive_(primitive), what_(what), to_root_(to_root), tally_(tally),
        warnings_(warnings) {
    matrix_of_directions(to_root, turn_);
    flipped_ = determinant(turn_) < 0.0;
  }

  Piece build(const pl_model &model, const Needs &needs);
  void measure(Extent &extent);

private:
  int attribute(const char *name) const {
    const auto it = primitive_.attributes.find(name);
    return it == primitive_.attributes.end() ? -1 : it->second;
  }
  Accessor open(const char *name, int low, int high) const;
  std::vector<uint32_t> corner_list(size_t vertices) const;
  bool is_mesh();
  Accessor open_mesh();
  void read_triangles(size_t vertices);
  bool drop_degenerate();
  void place_triangles(const Accessor &positions);
  void number_vertices(size_t vertices);
  void read_positions(const Accessor &positions);
  void read_normals(const Accessor &normals);
  void flat_normals();
  void repair_normals(const std::vector<uint32_t> &bad);
  void warn_of_unread() const;
  void read_uvs();
  void read_colors();
  void read_tangents(const Accessor &tangents);
  void copy_vertex(uint32_t vertex);
  void add_tangents(const Needs &needs);
  Vec face(
      /* cross product of two edges: length is twice the area, direction that of the normal */
      size_t triangle) const;

  Vec place(const Accessor &positions, uint32_t vertex) const;
  /* converts y-up to z-up, avoids -0 */
  Vec turn(const Vec &v) const { return {v.x, 0.0 - v.z, v.y}; }

  const Asset &asset_;
  const tinygltf::Primitive &primitive_;
  const std::string &what_;
  const Affine &to_root_;
  double turn_[3][3]; /* matrix for directions */
  bool flipped_;
  Tally &tally_;
  Warnings &warnings_;
  pl_vec3 origin_ = {0, 0, 0}; /* origin of the mesh */
  double unit_ = 1.0;

  Piece piece_;
  std::vector<uint32_t> source_; /* vertex index in the file for each vertex of the piece */
};

/* Component types other than float are those of KHR_mesh_quantization. They are also read in files
 * that do not declare the extension, since their meaning is unambiguous. */
Accessor Builder::open(const char *name, int low, int high) const {
  const Accessor accessor(asset_, attribute(name), what_ + "." + name);
  if (accessor.components() < low || accessor.components() > high)
    fail(PL_E_FORMAT, "%s.%s: %d components; must have %d", what_.c_str(), name,
         accessor.components(), low);
  return accessor;
}

/* Returns the vertices in drawing order: the index accessor, or 0, 1, 2 ... */
std::vector<uint32_t> Builder::corner_list(size_t vertices) const {
  std::vector<uint32_t> list;
  if (primitive_.indices < 0) {
    if (vertices >= NONE)
      fail(PL_E_UNSUPPORTED, "%s: %zu vertices", what_.c_str(), vertices);
    list.resize(vertices);
    for (size_t i = 0; i < vertices; i++)
      list[i] = static_cast<uint32_t>(i);
    return list;
  }
  const std::string name = what_ + ".indices";
  const Accessor indices(asset_, primitive_.indices, name);
  if (indices.components() != 1 || !indices.is_unsigned_integer() || indices.normalized())
    fail(PL_E_FORMAT, "%s: must be unsigned integer scalars", name.c_str());
  list.resize(indices.count());
  for (size_t i = 0; i < list.size(); i++) {
    list[i] = indices.read_index(i);
    if (list[i] == indices.restart_value())
      fail(PL_E_FORMAT, "%s: entry %zu is %u, the primitive restart value, which glTF forbids",
           name.c_str(), i, list[i]);
    if (list[i] >= vertices)
      fail(PL_E_FORMAT, "%s: entry %zu is %u, but there are %zu vertices", name.c_str(), i, list[i],
           vertices);
  }
  return list;
}

void Builder::read_triangles(size_t vertices) {
  const int mode = primitive_.mode;
  const bool list_mode = mode == TINYGLTF_MODE_TRIANGLES;
  /* The size is checked before any memory is allocated: an accessor may have a large count without
   * any bytes. */
  const size_t corners =
      primitive_.indices < 0
          ? vertices
          : asset_.model.accessors[static_cast<size_t>(primitive_.indices)].count;
  const size_t count = list_mode ? corners / 3 : corners < 3 ? 0 : corners - 2;
  tally_.triangles = std::min(tally_.triangles, SIZE_MAX - count) + count;
  if (tally_.triangles > FREE_TRIANGLES + asset_.file_bytes)
    fail(PL_E_RANGE, "%s: more triangles (%zu) than a file of %zu bytes may have", what_.c_str(),
         tally_.triangles, asset_.file_bytes);
  const std::vector<uint32_t> list = corner_list(vertices);
  if (list_mode ? list.size() % 3 != 0 : list.size() < 3)
    warnings_.add("%s: %zu corners make no whole triangles; the rest is left out", what_.c_str(),
                  list.size());
  piece_.triangles.reserve(3 * count);
  for (size_t t = 0; t < count; t++) {
    size_t a = 3 * t, b = 3 * t + 1, c = 3 * t + 2;
    if (mode == TINYGLTF_MODE_TRIANGLE_STRIP)
      a = t, b = t + 1 + t % 2, c = t + 2 - t % 2;
    else if (mode == TINYGLTF_MODE_TRIANGLE_FAN)
      a = t + 1, b = t + 2, c = 0;
    if (flipped_)
      std::swap(b, c);
    piece_.triangles.insert(piece_.triangles.end(), {list[a], list[b], list[c]});
  }
}

/* Returns a position in model units. */
Vec Builder::place(const Accessor &positions, uint32_t vertex) const {
  float p[4];
  positions.read(vertex, p);
  const double x = static_cast<double>(p[0]), y = static_cast<double>(p[1]),
               z = static_cast<double>(p[2]);
  const auto &m = to_root_.m;
  const Vec root = {m[0][0] * x + m[0][1] * y + m[0][2] * z + to_root_.t[0],
                    m[1][0] * x + m[1][1] * y + m[1][2] * z + to_root_.t[1],
                    m[2][0] * x + m[2][1] * y + m[2][2] * z + to_root_.t[2]};
  return turn(root);
}

/* Numbers the used vertices in the order of the file. A table of all vertices is faster than
 * sorting, unless the accessor is much larger than the part that this primitive uses. */
void Builder::number_vertices(size_t vertices) {
  std::vector<uint32_t> &triangles = piece_.triangles;
  if (vertices <= 8 * triangles.size()) {
    std::vector<uint32_t> number(vertices, NONE);
    for (const uint32_t v : triangles)
      number[v] = 0;
    for (uint32_t v = 0; v < vertices; v++)
      if (number[v] == 0) {
        number[v] = static_cast<uint32_t>(source_.size());
        source_.push_back(v);
      }
    for (uint32_t &v : triangles)
      v = number[v];
    return;
  }
  source_ = triangles;
  std::sort(source_.begin(), source_.end());
  source_.erase(std::unique(source_.begin(), source_.end()), source_.end());
  for (uint32_t &v : triangles)
    v = static_cast<uint32_t>(std::lower_bound(source_.begin(), source_.end(), v) -
                              source_.begin());
}

void Builder::read_positions(const Accessor &positions) {
  piece_.positions.resize(3 * source_.size());
  for (size_t v = 0; v < source_.size(); v++) {
    const Vec q = place(positions, source_[v]);
    piece_.positions[3 * v] = static_cast<float>((q.x - origin_.x) / unit_);
    piece_.positions[3 * v + 1] = static_cast<float>((q.y - origin_.y) / unit_);
    piece_.positions[3 * v + 2] = static_cast<float>((q.z - origin_.z) / unit_);
  }
}

Vec Builder::face(size_t triangle) const {
  Vec corner[3];
  for (size_t k = 0; k < 3; k++) {
    const float *p = &piece_.positions[3 * static_cast<size_t>(piece_.triangles[3 * triangle + k])];
    corner[k] = {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
  }
  return cross(corner[1] - corner[0], corner[2] - corner[0]);
}

/* Removes triangles that are degenerate in their stored positions; returns true when there are
 * none. (The test uses the stored floats: GCC 12 optimises double -> float -> double away when it
 * vectorises, so rounding a local double would not work.) Triangles with a vertex outside the
 * extent had no area before rounding. */
bool Builder::drop_degenerate() {
  std::vector<uint32_t> kept;
  kept.reserve(piece_.triangles.size());
  for (size_t t = 0; t < piece_.triangles.size(); t += 3) {
    bool finite = true, within = true;
    for (size_t k = 0; k < 9; k++) {
      const float x =
          piece_.positions[3 * static_cast<size_t>(piece_.triangles[t + k / 3]) + k % 3];
      finite = finite && std::isfinite(x);
      within = within && std::fabs(x) <= OUTERMOST;
    }
    if (!finite)
      tally_.not_finite++;
    else if (!within || !(norm(face(t / 3)) > 0.0))
      tally_.zero_area++;
    else
      kept.insert(kept.end(), &piece_.triangles[t], &piece_.triangles[t] + 3);
  }
  const bool all = kept.size() == piece_.triangles.size();
  piece_.triangles.swap(kept);
  return all;
}

/* Keeps only the vertices of non-degenerate triangles, with their positions. */
void Builder::place_triangles(const Accessor &positions) {
  number_vertices(positions.count());
  read_positions(positions);
  if (drop_degenerate())
    return;
  for (uint32_t &v : piece_.triangles)
    v = source_[v];
  source_.clear();
  number_vertices(positions.count());
  read_positions(positions);
}

void put_unit(std::vector<float> &array, size_t vertex, const Vec &v) {
  const double length = norm(v);
  array[3 * vertex] = static_cast<float>(v.x / length);
  array[3 * vertex + 1] = static_cast<float>(v.y / length);
  array[3 * vertex + 2] = static_cast<float>(v.z / length);
}

/* Flat shading for files without normals (section 3.7.2.1): no vertex is shared. */
void Builder::flat_normals() {
  std::vector<uint32_t> source(piece_.triangles.size());
  std::vector<float> positions(3 * piece_.triangles.size());
  piece_.normals.resize(positions.size());
  for (size_t c = 0; c < piece_.triangles.size(); c++) {
    source[c] = source_[piece_.triangles[c]];
    std::copy_n(&piece_.positions[3 * static_cast<size_t>(piece_.triangles[c])], 3,
                &positions[3 * c]);
    put_unit(piece_.normals, c, face(c / 3));
  }
  for (size_t c = 0; c < piece_.triangles.size(); c++)
    piece_.triangles[c] = static_cast<uint32_t>(c);
  source_.swap(source);
  piece_.positions.swap(positions);
}

/* Normals are transformed by the cofactor matrix: the inverse transpose without its division, which
 * would fail for singular nodes. The sign keeps them outward under mirroring. */
void Builder::read_normals(const Accessor &normals) {
  const auto &m = turn_;
  const double sign = flipped_ ? -1.0 : 1.0;
  std::vector<uint32_t> bad;
  piece_.normals.resize(3 * source_.size());
  for (size_t v = 0; v < source_.size(); v++) {
    float n[4];
    normals.read(source_[v], n);
    const double in[3] = {static_cast<double>(n[0]), static_cast<double>(n[1]),
                          static_cast<double>(n[2])};
    const double length = norm({in[0], in[1], in[2]});
    double out[3];
    for (int i = 0; i < 3; i++) {
      const auto &a = m[(i + 1) % 3], &b = m[(i + 2) % 3];
      out[i] = sign * ((a[1] * b[2] - a[2] * b[1]) * in[0] + (a[2] * b[0] - a[0] * b[2]) * in[1] +
                       (a[0] * b[1] - a[1] * b[0]) * in[2]);
    }
    const Vec turned = turn({out[0], out[1], out[2]});
    if (length > SHORTEST_NORMAL && std::isfinite(length) && norm(turned) > 0.0 &&
        std::isfinite(norm(turned)))
      put_unit(piece_.normals, v, turned);
    else
      bad.push_back(static_cast<uint32_t>(v));
  }
  if (!bad.empty())
    repair_normals(bad);
}

/* Replaces normals without direction by the area-weighted mean of the face normals around the
 * vertex. */
void Builder::repair_normals(const std::vector<uint32_t> &bad) {
  tally_.bad_normals += bad.size();
  std::vector<Vec> sum(piece_.vertices()), any(piece_.vertices());
  for (size_t c = 0; c < piece_.triangles.size(); c++) {
    const Vec f = face(c / 3);
    Vec &s = sum[piece_.triangles[c]];
    s = {s.x + f.x, s.y + f.y, s.z + f.z};
    any[piece_.triangles[c]] = f;
  }
  for (const uint32_t v : bad) /* normals of opposite faces may cancel */
    put_unit(piece_.normals, v, norm(sum[v]) > 1e-6 * norm(any[v]) ? sum[v] : any[v]);
}

/* Warns about attributes that are not read; skins and attributes that materials need have their own
 * warnings. */
void Builder::warn_of_unread() const {
  static const char *const read[] = {"POSITION",   "NORMAL",     "TANGENT", "COLOR_0",
                                     "TEXCOORD_0", "TEXCOORD_1", "JOINTS_", "WEIGHTS_"};
  for (const auto &entry : primitive_.attributes) {
    const std::string &name = entry.first;
    const bool known = std::any_of(std::begin(read), std::end(read), [&](const char *prefix) {
      return name.rfind(prefix, 0) == 0 && (name == prefix || prefix[strlen(prefix) - 1] == '_');
    });
    if (!known && name[0] != '_') /* names that begin with an underscore are application-specific */
      warnings_.add("%s: the attribute %s is not read", what_.c_str(), printable(name).c_str());
  }
}

void Builder::read_uvs() {
  const char *const names[2] = {"TEXCOORD_0", "TEXCOORD_1"};
  for (int set = 0; set < 2; set++) {
    if (attribute(names[set]) < 0)
      continue;
    const Accessor uvs = open(names[set], 2, 2);
    bool bad = false;
    piece_.uvs[set].resize(2 * source_.size());
    for (size_t v = 0; v < source_.size(); v++) {
      float uv[4] = {0};
      uvs.read(source_[v], uv);
      bad = bad || !std::isfinite(uv[0]) || !std::isfinite(uv[1]);
      for (size_t k = 0; k < 2; k++)
        piece_.uvs[set][2 * v + k] = std::isfinite(uv[k]) ? uv[k] : 0.0f;
    }
    if (bad)
      warnings_.add("%s.%s: numbers that are not finite count as 0", what_.c_str(), names[set]);
  }
}

void Builder::read_colors() {
  if (attribute("COLOR_0") < 0)
    return;
  const Accessor colors = open("COLOR_0", 3, 4);
  bool outside = false, broken = false;
  piece_.colors.resize(4 * source_.size());
  for (size_t v = 0; v < source_.size(); v++) {
    float color[4] = {1, 1, 1, 1};
    colors.read(source_[v], color);
    for (size_t k = 0; k < 4; k++) {
      const bool finite = std::isfinite(color[k]);
      broken = broken || !finite;
      outside = outside || (finite && (color[k] < 0.0f || color[k] > 1.0f));
      piece_.colors[4 * v + k] = finite ? std::min(std::max(color[k], 0.0f), 1.0f) : 1.0f;
    }
  }
  if (outside)
    warnings_.add("%s.COLOR_0: numbers are clamped to 0..1", what_.c_str());
  if (broken)
    warnings_.add("%s.COLOR_0: numbers that are not finite count as 1", what_.c_str());
}

/* Tangents of the file lie in the surface, so they are transformed by the matrix itself. */
void Builder::read_tangents(const Accessor &tangents) {
  const auto &m = turn_;
  bool replaced = false;
  for (size_t v = 0; v < source_.size(); v++) {
    float in[4];
    tangents.read(source_[v], in);
    const double t[3] = {static_cast<double>(in[0]), static_cast<double>(in[1]),
                         static_cast<double>(in[2])};
    const Vec turned = turn({m[0][0] * t[0] + m[0][1] * t[1] + m[0][2] * t[2],
                             m[1][0] * t[0] + m[1][1] * t[1] + m[1][2] * t[2],
                             m[2][0] * t[0] + m[2][1] * t[1] + m[2][2] * t[2]});
    const double length = norm(turned);
    if (!(length > 0.0) || !std::isfinite(length)) {
      replaced = true; /* keeps the computed tangent */
      continue;
    }
    piece_.tangents[4 * v] = static_cast<float>(turned.x / length);
    piece_.tangents[4 * v + 1] = static_cast<float>(turned.y / length);
    piece_.tangents[4 * v + 2] = static_cast<float>(turned.z / length);
    piece_.tangents[4 * v + 3] = (in[3] < 0.0f) == flipped_ ? 1.0f : -1.0f;
  }
  if (replaced)
    warnings_.add("%s.TANGENT: degenerate tangents are replaced", what_.c_str());
}

/* Appends a copy of a vertex: all attributes that have been read before tangents are computed. */
void Builder::copy_vertex(uint32_t vertex) {
  const auto copy = [vertex](std::vector<float> &array, size_t components) {
    for (size_t k = 0; k < components && !array.empty(); k++)
      array.push_back(array[components * vertex + k]);
  };
  source_.push_back(source_[vertex]);
  copy(piece_.positions, 3);
  copy(piece_.normals, 3);
  copy(piece_.uvs[0], 2);
  copy(piece_.uvs[1], 2);
}

/* Computes tangents where the file has none or degenerate ones; without texture coordinates they
 * are any direction orthogonal to the normal. Tangents in a file without normals are ignored
 * (section 3.7.2.1). */
void Builder::add_tangents(const Needs &needs) {
  const bool given = attribute("TANGENT") >= 0 && attribute("NORMAL") >= 0;
  const std::vector<float> &uvs = piece_.uvs[needs.tangent_uv_set];
  if (uvs.empty() && !given)
    return;
  if (!given)
    for (const uint32_t v : split_by_handedness(piece_.triangles, source_.size(), uvs))
      copy_vertex(v);
  compute_tangents(piece_, needs.tangent_uv_set);
  if (given)
    read_tangents(open("TANGENT", 4, 4));
}

/* Returns true if the primitive has triangles; counts points, lines and primitives without
 * positions. */
bool Builder::is_mesh() {
  if (primitive_.mode == TINYGLTF_MODE_POINTS)
    return tally_.points++, false;
  if (primitive_.mode < TINYGLTF_MODE_TRIANGLES)
    return tally_.lines++, false;
  if (attribute("POSITION") < 0)
    return tally_.unplaced++, false;
  return true;
}

/* Opens the positions and reads the triangles; checks that all attributes have the same number of
 * vertices. */
Accessor Builder::open_mesh() {
  Accessor positions = open("POSITION", 3, 3);
  for (const auto &entry : primitive_.attributes) {
    const size_t count = asset_.model.accessors[static_cast<size_t>(entry.second)].count;
    if (count != positions.count())
      fail(PL_E_FORMAT, "%s.%s: %zu elements, but POSITION has %zu", what_.c_str(),
           printable(entry.first).c_str(), count, positions.count());
  }
  if (!primitive_.targets.empty())
    warnings_.add("%s: morph targets are ignored: the mesh keeps its base shape", what_.c_str());
  warn_of_unread();
  read_triangles(positions.count());
  return positions;
}

/* Returns true if three points form a triangle of non-zero area, at any scale. */
bool spans(const Vec corner[3]) {
  Vec a = corner[1] - corner[0], b = corner[2] - corner[0];
  double most = 0.0;
  for (const double x : {a.x, a.y, a.z, b.x, b.y, b.z})
    most = std::fmax(most, std::fabs(x));
  if (!(most > 0.0) || !std::isfinite(most))
    return false;
  a = {a.x / most, a.y / most, a.z / most};
  b = {b.x / most, b.y / most, b.z / most};
  return norm(cross(a, b)) > 0.0;
}

void Builder::measure(Extent &extent) {
  if (!is_mesh())
    return;
  const Accessor positions = open_mesh();
  for (size_t t = 0; t < piece_.triangles.size(); t += 3) {
    Vec corner[3];
    for (size_t k = 0; k < 3; k++)
      corner[k] = place(positions, piece_.triangles[t + k]);
    if (!spans(corner))
      continue;
    for (const Vec &p : corner) {
      const double at[3] = {p.x, p.y, p.z};
      for (size_t k = 0; k < 3; k++) {
        extent.low[k] = std::min(extent.low[k], at[k]);
        extent.high[k] = std::max(extent.high[k], at[k]);
      }
    }
  }
}

Piece Builder::build(const pl_model &model, const Needs &needs) {
  origin_ = model.origin;
  unit_ = model.unit;
  if (!is_mesh())
    return Piece();
  const Accessor positions = open_mesh();
  place_triangles(positions);
  if (piece_.triangles.empty())
    return Piece();
  if (attribute("NORMAL") >= 0)
    read_normals(open("NORMAL", 3, 3));
  else
    flat_normals();
  read_uvs();
  for (int set = 0; set < 2; set++)
    if (needs.uv_set[set] && piece_.uvs[set].empty())
      warnings_.add("%s: its material has a map, but it has no TEXCOORD_%d", what_.c_str(), set);
  if (needs.tangents)
    add_tangents(needs);
  read_colors();
  return std::move(piece_);
}

} // namespace

void measure_primitive(const Asset &asset, const tinygltf::Primitive &primitive,
                       const std::string &what, const Affine &to_root, Tally &tally,
                       Warnings &warnings, Extent &extent) {
  Builder(asset, primitive, what, to_root, tally, warnings).measure(extent);
}

Piece read_primitive(const Asset &asset, const tinygltf::Primitive &primitive,
                     const std::string &what, const Affine &to_root, const pl_model &model,
                     const Needs &needs, Tally &tally, Warnings &warnings) {
  return Builder(asset, primitive, what, to_root, tally, warnings).build(model, needs);
}

} // namespace pl_gltf
