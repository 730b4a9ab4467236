/* glTF 2.0 reader: the C interface, the scene traversal, and the flattened model. */
#include "io/gltf.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <memory>
#include <new>

#include "base/memory.h"
#include "io/gltf_decoded.hpp"
#include "io/gltf_guard.hpp"
#include "io/gltf_material.hpp"
#include "io/gltf_mesh.hpp"
#include "io/gltf_motion.hpp"

namespace pl_gltf {

namespace {

struct ModelDeleter {
  void operator()(pl_model *model) const { pl_model_destroy(model); }
};
using ModelPtr = std::unique_ptr<pl_model, ModelDeleter>;

/* animations: the JSON of the file's animations, which is not given to tinygltf. */
Asset parse_asset(const std::string &path, nlohmann::json &animations, Warnings &warnings) {
  Source source(path);
  for (const std::string &remark : source.remarks())
    warnings.add("%s", remark.c_str());
  nlohmann::json document = parse_and_check(source, warnings);
  Asset asset;
  asset.buffers = load_buffers(document, source);
  asset.images = load_images(document, source);
  if (document.contains("animations"))
    animations = std::move(document["animations"]);
  asset.no_view = strip_for_parser(document);
  const std::string text = document.dump();
  document = nullptr; /* frees it before the parser allocates its own */
  tinygltf::TinyGLTF parser;
  std::string error, warning;
  if (text.size() > INT32_MAX ||
      !parser.LoadASCIIFromString(&asset.model, &error, &warning, text.data(),
                                  static_cast<unsigned>(text.size()), "", tinygltf::NO_REQUIRE))
    fail(PL_E_FORMAT, "%s", printable(error).c_str());
  asset.source = std::make_shared<Source>(std::move(source));
  decode_meshopt(asset);
  decode_draco(asset, warnings);
  asset.file_bytes = asset.source->total_bytes() + asset.decoded_bytes;
  return asset;
}

/* Arrays of the model under construction. */
struct Flat {
  std::vector<float> positions, normals, tangents, uvs[2], colors;
  std::vector<uint32_t> indices, triangle_part;
  struct Part {
    std::string name;
    int node, mesh, primitive, material;
  };
  std::vector<Part> parts;
};

/* Appends an optional array; vertices without values get `standard`. */
void append_optional(std::vector<float> &all, const std::vector<float> &some, size_t before,
                     size_t added, const std::vector<float> &standard) {
  if (all.empty() && some.empty())
    return;
  const size_t n = standard.size();
  while (all.size() < n * before)
    all.insert(all.end(), standard.begin(), standard.end());
  all.insert(all.end(), some.begin(), some.end());
  while (all.size() < n * (before + added))
    all.insert(all.end(), standard.begin(), standard.end());
}

void append(Flat &flat, const Piece &piece) {
  const size_t before = flat.positions.size() / 3, added = piece.vertices();
  if (before + added >= UINT32_MAX)
    fail(PL_E_RANGE, "more than 2^32 vertices");
  flat.positions.insert(flat.positions.end(), piece.positions.begin(), piece.positions.end());
  flat.normals.insert(flat.normals.end(), piece.normals.begin(), piece.normals.end());
  append_optional(flat.tangents, piece.tangents, before, added, {1, 0, 0, 1});
  for (int set = 0; set < 2; set++)
    append_optional(flat.uvs[set], piece.uvs[set], before, added, {0, 0});
  append_optional(flat.colors, piece.colors, before, added, {1, 1, 1, 1});
  for (const uint32_t v : piece.triangles)
    flat.indices.push_back(static_cast<uint32_t>(before) + v);
  flat.triangle_part.insert(flat.triangle_part.end(), piece.triangles.size() / 3,
                            static_cast<uint32_t>(flat.parts.size() - 1));
}

/* Traverses the scene, which determines its extent, and flattens it. */
class Walker {
public:
  Walker(const Asset &asset, const Affine &base, Warnings &warnings)
      : asset_(asset), base_(base), warnings_(warnings),
        used_(asset.model.materials.size() + 1, false), placed_(asset.model.nodes.size()) {}

  void walk_scene();
  const Extent &extent() const { return extent_; }
  void flatten(const pl_model &model); /* its unit must be set */
  const Tally &tally() const { return tally_; }
  const std::vector<bool> &used_materials() const { return used_; }
  const std::vector<Placed> &placed() const { return placed_; }
  const std::vector<int> &order() const { return order_; }
  Flat &flat() { return flat_; }

private:
  std::vector<int> roots() const;
  void walk_node(int index, int parent, const Affine &parent_to_root);
  void find_mesh(int mesh, int node, const Affine &to_root);

  /* A mesh and the transform that places it. */
  struct Use {
    int mesh, node;
    Affine to_root;
  };
  void add_mesh(const Use &use, const pl_model &model);

  const Asset &asset_;
  const Affine base_; /* parent transform of the root nodes */
  Warnings &warnings_;
  std::vector<bool> used_;
  std::vector<Placed> placed_; /* by node index */
  std::vector<int> order_;     /* in the order of the traversal */
  std::vector<Use> uses_;
  Extent extent_;
  Tally measured_, tally_; /* counts of the measuring pass and of the reading pass */
  Flat flat_;
};

/* Returns the root nodes of the default scene; of the first scene when there is no default; all
 * root nodes when the file has no scene. */
std::vector<int> Walker::roots() const {
  const tinygltf::Model &model = asset_.model;
  std::vector<bool> child(model.nodes.size(), false);
  for (const tinygltf::Node &node : model.nodes)
    for (const int c : node.children)
      child[static_cast<size_t>(c)] = true;
  std::vector<int> out;
  if (model.scenes.empty()) {
    for (size_t i = 0; i < model.nodes.size(); i++)
      if (!child[i])
        out.push_back(static_cast<int>(i));
    return out;
  }
  const int scene = std::max(model.defaultScene, 0);
  for (const int root : model.scenes[static_cast<size_t>(scene)].nodes) {
    if (child[static_cast<size_t>(root)])
      fail(PL_E_FORMAT, "scenes[%d]: nodes[%d] is not a root node", scene, root);
    child[static_cast<size_t>(root)] = true; /* so that it cannot be listed twice */
    out.push_back(root);
  }
  return out;
}

void Walker::walk_scene() {
  if (asset_.model.nodes.empty() && !asset_.model.meshes.empty()) {
    warnings_.add("there are no nodes: every mesh is placed once, as it is");
    for (size_t i = 0; i < asset_.model.meshes.size(); i++)
      find_mesh(static_cast<int>(i), -1, base_);
    return;
  }
  for (const int root : roots())
    walk_node(root, -1, base_);
  const std::vector<tinygltf::Node> &nodes = asset_.model.nodes;
  size_t outside = 0;
  for (size_t i = 0; i < nodes.size(); i++)
    outside += !placed_[i].in_scene && nodes[i].mesh >= 0;
  if (outside > 0)
    warnings_.add("%zu nodes with meshes are not in the scene and left out", outside);
}

/* Precondition, checked by the guard: nodes form a forest of limited depth. */
void Walker::walk_node(int index, int parent, const Affine &parent_to_root) {
  const tinygltf::Node &node = asset_.model.nodes[static_cast<size_t>(index)];
  const Affine local = node_transform(node, static_cast<size_t>(index), warnings_);
  const Affine to_root = compose(parent_to_root, local);
  placed_[static_cast<size_t>(index)] = {true, parent, local};
  order_.push_back(index);
  if (node.mesh >= 0)
    find_mesh(node.mesh, index, to_root);
  for (const int child : node.children)
    walk_node(child, index, to_root);
}

std::string primitive_name(int mesh, size_t primitive) {
  return "meshes[" + std::to_string(mesh) + "].primitives[" + std::to_string(primitive) + "]";
}

void Walker::find_mesh(int mesh_index, int node_index, const Affine &to_root) {
  const tinygltf::Mesh &mesh = asset_.model.meshes[static_cast<size_t>(mesh_index)];
  for (size_t i = 0; i < mesh.primitives.size(); i++)
    measure_primitive(asset_, mesh.primitives[i], primitive_name(mesh_index, i), to_root, measured_,
                      warnings_, extent_);
  uses_.push_back({mesh_index, node_index, to_root});
}

void Walker::flatten(const pl_model &model) {
  for (const Use &use : uses_)
    add_mesh(use, model);
}

void Walker::add_mesh(const Use &use, const pl_model &model) {
  const int mesh_index = use.mesh, node_index = use.node;
  const tinygltf::Mesh &mesh = asset_.model.meshes[static_cast<size_t>(mesh_index)];
  std::string name =
      node_index >= 0 ? asset_.model.nodes[static_cast<size_t>(node_index)].name : "";
  if (name.empty())
    name = mesh.name;
  if (name.empty())
    name = node_index >= 0 ? "node " + std::to_string(node_index)
                           : "mesh " + std::to_string(mesh_index);
  for (size_t i = 0; i < mesh.primitives.size(); i++) {
    const tinygltf::Primitive &primitive = mesh.primitives[i];
    const Piece piece =
        read_primitive(asset_, primitive, primitive_name(mesh_index, i), use.to_root, model,
                       needs_of_material(asset_, primitive.material), tally_, warnings_);
    if (piece.triangles.empty())
      continue;
    const size_t material =
        primitive.material >= 0 ? static_cast<size_t>(primitive.material) : used_.size() - 1;
    used_[material] = true;
    flat_.parts.push_back(
        {name, node_index, mesh_index, static_cast<int>(i), static_cast<int>(material)});
    append(flat_, piece);
  }
}

void report(const Tally &tally, Warnings &warnings) {
  if (tally.zero_area > 0)
    warnings.add("%zu zero-area triangles are left out", tally.zero_area);
  if (tally.not_finite > 0)
    warnings.add("%zu triangles with non-finite positions are left out", tally.not_finite);
  if (tally.bad_normals > 0)
    warnings.add("%zu degenerate normals are replaced", tally.bad_normals);
  if (tally.points > 0)
    warnings.add("%zu primitives of points are skipped", tally.points);
  if (tally.lines > 0)
    warnings.add("%zu primitives of lines are skipped", tally.lines);
  if (tally.unplaced > 0)
    warnings.add("%zu primitives without POSITION are skipped", tally.unplaced);
}

[[noreturn]] void refuse_empty(const Tally &tally) {
  Warnings reasons;
  report(tally, reasons);
  std::string text = reasons.text();
  std::replace(text.begin(), text.end(), '\n', ',');
  fail(PL_E_FORMAT, "there is no triangle to render%s%s", text.empty() ? "" : ": ", text.c_str());
}

/* Moves an array into the model's memory; NULL when it is empty. Allocates one element more: Embree
 * reads 16 bytes for the last vertex, which has 12. */
template <typename T> T *move_out(std::vector<T> &from, const char *what) {
  if (from.empty())
    return nullptr;
  void *memory;
  if (pl_alloc_or_fail(from.size() + 1, sizeof(T), what, &memory) != PL_OK)
    fail(PL_E_MEMORY, "%s", pl_error_text());
  memcpy(memory, from.data(), from.size() * sizeof(T));
  std::vector<T>().swap(from);
  return static_cast<T *>(memory);
}

void fill_arrays(Flat &flat, pl_model *model) {
  model->vertex_count = flat.positions.size() / 3;
  model->triangle_count = flat.indices.size() / 3;
  model->positions = move_out(flat.positions, "positions");
  model->normals = move_out(flat.normals, "normals");
  model->tangents = move_out(flat.tangents, "tangents");
  for (int set = 0; set < 2; set++)
    model->uvs[set] = move_out(flat.uvs[set], "texture coordinates");
  model->colors = move_out(flat.colors, "vertex colours");
  model->indices = move_out(flat.indices, "indices");
  model->triangle_part = move_out(flat.triangle_part, "parts of triangles");
  void *memory;
  if (pl_alloc_or_fail(flat.parts.size(), sizeof(pl_part), "parts", &memory) != PL_OK)
    fail(PL_E_MEMORY, "%s", pl_error_text());
  model->parts = static_cast<pl_part *>(memory);
  model->part_count = flat.parts.size();
  for (size_t i = 0; i < flat.parts.size(); i++) {
    const Flat::Part &part = flat.parts[i];
    model->parts[i] = {copy_text(part.name), part.node, part.mesh, part.primitive, part.material};
  }
}

/* Apart from signs, the model's axes (x, y, z) are the file's (x, z, y). */
Affine stretched(const double *stretch) {
  Affine out;
  if (stretch != nullptr)
    for (size_t i = 0; i < 3; i++)
      out.m[i][i] = stretch[std::array<size_t, 3>{0, 2, 1}[i]];
  return out;
}

ModelPtr load(const std::string &path, const double *stretch) {
  Warnings warnings;
  nlohmann::json animations;
  const Asset asset = parse_asset(path, animations, warnings);
  Walker walker(asset, stretched(stretch), warnings);
  walker.walk_scene();
  void *memory;
  if (pl_alloc_or_fail(1, sizeof(pl_model), "a model", &memory) != PL_OK)
    fail(PL_E_MEMORY, "%s", pl_error_text());
  ModelPtr model(static_cast<pl_model *>(memory));
  const Extent &e = walker.extent();
  const bool any = e.low[0] <= e.high[0];
  pl_model_set_unit(model.get(), any ? pl_vec3{e.low[0], e.low[1], e.low[2]} : pl_vec3{0, 0, 0},
                    any ? pl_vec3{e.high[0], e.high[1], e.high[2]} : pl_vec3{0, 0, 0});
  walker.flatten(*model);
  const Tally &tally = walker.tally();
  report(tally, warnings);
  if (walker.flat().indices.empty())
    refuse_empty(tally);
  fill_arrays(walker.flat(), model.get());
  build_nodes(asset, walker.placed(), walker.order(), model.get());
  model->nodes.stretched = stretch != nullptr;
  if (stretch != nullptr)
    model->nodes.stretch = {stretch[0], stretch[1], stretch[2]};
  build_animations(asset, animations, walker.placed(), model.get(), warnings);
  build_materials(asset, walker.used_materials(), model.get(), warnings);
  pl_model_measure(model.get());
  model->warnings = copy_text(warnings.text());
  return model;
}

} // namespace

} // namespace pl_gltf

extern "C" pl_status pl_gltf_load(const char *path, const double stretch[3], pl_model **out) {
  *out = nullptr;
  try {
    *out = pl_gltf::load(path, stretch).release();
    return PL_OK;
  } catch (const pl_gltf::Fault &fault) {
    return pl_fail(fault.status, "%s: %s", path, fault.text.c_str());
  } catch (const std::bad_alloc &) {
    return pl_fail(PL_E_MEMORY, "%s: out of memory", path);
  } catch (const std::exception &error) {
    return pl_fail(PL_E_FORMAT, "%s: %s", path, error.what());
  } catch (...) {
    return pl_fail(PL_E_FORMAT, "%s: unexpected failure", path);
  }
}
