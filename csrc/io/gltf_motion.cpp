/* Nodes (glTF 2.0, section 3.5) and animations (3.11), converted to model axes: (x, y, z) of the
 * file becomes (x, -z, y). */
#include "io/gltf_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/memory.h"

namespace pl_gltf {

namespace {

using nlohmann::json;

/* Limit on the numbers of animations by the size of a file: this many for any file, plus one per
 * byte. (Channels may share accessors, so there can be more numbers than the bytes could hold.) */
constexpr size_t FREE_NUMBERS = size_t{1} << 20;

/* File axis of each model axis, and its sign. */
constexpr size_t AXIS[3] = {0, 2, 1};
constexpr double SIGN[3] = {1, -1, 1};

pl_vec3 turned(const double v[3]) { return {v[AXIS[0]], -v[AXIS[1]], v[AXIS[2]]}; }

pl_affine turned(const Affine &a) {
  double m[3][3];
  for (size_t i = 0; i < 3; i++)
    for (size_t j = 0; j < 3; j++)
      m[i][j] = SIGN[i] * SIGN[j] * a.m[AXIS[i]][AXIS[j]];
  pl_affine out;
  for (size_t i = 0; i < 3; i++)
    out.m.row[i] = {m[i][0], m[i][1], m[i][2]};
  out.t = turned(a.t);
  return out;
}

/* Preconditions: the guard has checked array lengths, the scene traversal that the rotation has a
 * non-zero length. */
pl_trs trs_of(const tinygltf::Node &node) {
  pl_trs out = {{0, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}};
  if (node.translation.size() == 3)
    out.t = turned(node.translation.data());
  if (node.rotation.size() == 4) {
    const std::vector<double> &q = node.rotation;
    out.q = pl_quat_unit({q[3], q[0], -q[2], q[1]});
  }
  if (node.scale.size() == 3)
    out.s = {node.scale[0], node.scale[2], node.scale[1]};
  return out;
}

template <typename T> T *allocate(size_t count, const char *what) {
  void *memory;
  if (pl_alloc_or_fail(count, sizeof(T), what, &memory) != PL_OK)
    fail(PL_E_MEMORY, "%s", pl_error_text());
  return static_cast<T *>(memory);
}

/* Parts have the same names (gltf.cpp). */
std::string name_of(const tinygltf::Model &model, size_t index) {
  const tinygltf::Node &node = model.nodes[index];
  std::string name = node.name;
  if (name.empty() && node.mesh >= 0)
    name = model.meshes[static_cast<size_t>(node.mesh)].name;
  return name.empty() ? "node " + std::to_string(index) : name;
}

struct Track {
  int node;
  pl_track_path path;
  pl_interpolation interpolation;
  std::vector<float> times, values;
};

/* Reads one animation of the file; throws a Fault on any error. */
class Reader {
public:
  Reader(const Asset &asset, const json &value, const std::string &what,
         const std::vector<Placed> &placed, size_t &budget)
      : asset_(asset), value_(value), what_(what), placed_(placed), budget_(budget) {}

  std::vector<Track> read();
  size_t passed_over() const { return array("channels").size() - read_; }

private:
  const json &array(const char *key) const;
  const json *member(const json &object, const std::string &path, const char *key) const;
  int index(const json &object, const std::string &path, const char *key, size_t count) const;
  void read_channel(size_t k, std::vector<Track> &tracks) const;
  void read_sampler(size_t sampler, Track &track) const;
  void read_times(const Accessor &input, const std::string &path, Track &track) const;
  void read_values(const Accessor &output, const std::string &path, Track &track) const;

  const Asset &asset_;
  const json &value_;
  const std::string what_;
  const std::vector<Placed> &placed_;
  size_t &budget_;
  size_t read_ = 0; /* number of channels read */
};

const json &Reader::array(const char *key) const {
  const json *value = member(value_, what_, key);
  if (value == nullptr || !value->is_array())
    fail(PL_E_FORMAT, "%s.%s: must be an array", what_.c_str(), key);
  return *value;
}

const json *Reader::member(const json &object, const std::string &path, const char *key) const {
  if (!object.is_object())
    fail(PL_E_FORMAT, "%s: must be an object", path.c_str());
  const auto it = object.find(key);
  return it == object.end() ? nullptr : &*it;
}

int Reader::index(const json &object, const std::string &path, const char *key,
                  size_t count) const {
  const json *value = member(object, path, key);
  if (value == nullptr || !value->is_number_integer() || value->get<int64_t>() < 0 ||
      value->get<uint64_t>() >= count)
    fail(PL_E_FORMAT, "%s.%s: must be an index below %zu", path.c_str(), key, count);
  return value->get<int>();
}

std::vector<Track> Reader::read() {
  std::vector<Track> tracks;
  for (size_t k = 0; k < array("channels").size(); k++)
    read_channel(k, tracks);
  read_ = tracks.size();
  return tracks;
}

/* Skips channels without a node, and those of properties that are not read (weights, pointers). */
void Reader::read_channel(size_t k, std::vector<Track> &tracks) const {
  const json &channel = array("channels")[k];
  const std::string path = what_ + ".channels[" + std::to_string(k) + "]";
  const int sampler = index(channel, path, "sampler", array("samplers").size());
  const json *target = member(channel, path, "target");
  if (target == nullptr || member(*target, path + ".target", "node") == nullptr)
    return;
  Track track = {};
  track.node = index(*target, path + ".target", "node", placed_.size());
  const json *name = member(*target, path + ".target", "path");
  if (name == nullptr || !name->is_string())
    fail(PL_E_FORMAT, "%s.target.path: must be a string", path.c_str());
  if (*name == "translation")
    track.path = PL_TRACK_TRANSLATION;
  else if (*name == "rotation")
    track.path = PL_TRACK_ROTATION;
  else if (*name == "scale")
    track.path = PL_TRACK_SCALE;
  else
    return;
  const size_t node = static_cast<size_t>(track.node);
  if (asset_.model.nodes[node].matrix.size() == 16)
    fail(PL_E_FORMAT, "%s: nodes[%zu] has a matrix and cannot be animated", path.c_str(), node);
  for (const Track &other : tracks)
    if (other.node == track.node && other.path == track.path)
      fail(PL_E_FORMAT, "%s: nodes[%zu] has two channels of the same path", path.c_str(), node);
  if (!placed_[node].in_scene)
    return;
  read_sampler(static_cast<size_t>(sampler), track);
  tracks.push_back(std::move(track));
}

void Reader::read_sampler(size_t k, Track &track) const {
  const json &sampler = array("samplers")[k];
  const std::string path = what_ + ".samplers[" + std::to_string(k) + "]";
  const size_t accessors = asset_.model.accessors.size();
  const json *name = member(sampler, path, "interpolation");
  track.interpolation = PL_LINEAR;
  if (name != nullptr && *name == "STEP")
    track.interpolation = PL_STEP;
  else if (name != nullptr && *name == "CUBICSPLINE")
    track.interpolation = PL_CUBIC;
  else if (name != nullptr && *name != "LINEAR")
    fail(PL_E_FORMAT, "%s.interpolation: must be STEP, LINEAR or CUBICSPLINE", path.c_str());
  const Accessor input(asset_, index(sampler, path, "input", accessors), path + ".input");
  const Accessor output(asset_, index(sampler, path, "output", accessors), path + ".output");
  const size_t numbers = input.count() + 4 * output.count();
  if (input.count() > budget_ || output.count() > budget_ || numbers > budget_)
    fail(PL_E_RANGE, "%s: too many keys for the size of the file", path.c_str());
  budget_ -= numbers;
  read_times(input, path + ".input", track);
  read_values(output, path + ".output", track);
}

void Reader::read_times(const Accessor &input, const std::string &path, Track &track) const {
  if (input.components() != 1 || !input.is_float())
    fail(PL_E_FORMAT, "%s: must be SCALAR floats", path.c_str());
  for (size_t i = 0; i < input.count(); i++) {
    float time[4];
    input.read(i, time);
    if (!std::isfinite(time[0]) || (i > 0 && !(time[0] > track.times.back())))
      fail(PL_E_FORMAT, "%s: times must be finite and grow", path.c_str());
    track.times.push_back(time[0]);
  }
}

void Reader::read_values(const Accessor &output, const std::string &path, Track &track) const {
  const bool rotation = track.path == PL_TRACK_ROTATION;
  const size_t rows = track.interpolation == PL_CUBIC ? 3 : 1;
  if (output.components() != (rotation ? 4 : 3))
    fail(PL_E_FORMAT, "%s: must be %s", path.c_str(), rotation ? "VEC4" : "VEC3");
  if (output.count() != rows * track.times.size())
    fail(PL_E_FORMAT, "%s: %zu values for %zu keys, must be %zu", path.c_str(), output.count(),
         track.times.size(), rows * track.times.size());
  for (size_t i = 0; i < output.count(); i++) {
    float v[4] = {0, 0, 0, 0};
    output.read(i, v);
    for (const float x : v)
      if (!std::isfinite(x))
        fail(PL_E_FORMAT, "%s: values must be finite", path.c_str());
    if (rotation)
      track.values.insert(track.values.end(), {v[3], v[0], -v[2], v[1]});
    else if (track.path == PL_TRACK_SCALE)
      track.values.insert(track.values.end(), {v[0], v[2], v[1]});
    else
      track.values.insert(track.values.end(), {v[0], -v[2], v[1]});
  }
}

float *copy_floats(const std::vector<float> &from) {
  float *out = allocate<float>(from.size(), "an animation");
  memcpy(out, from.data(), from.size() * sizeof(float));
  return out;
}

void fill_animation(const std::vector<Track> &tracks, pl_animation *out) {
  out->tracks = allocate<pl_track>(tracks.size(), "an animation");
  out->count = tracks.size();
  out->start_s = INFINITY;
  out->stop_s = -INFINITY;
  for (size_t i = 0; i < tracks.size(); i++) {
    const Track &from = tracks[i];
    pl_track *track = &out->tracks[i];
    track->node = from.node;
    track->path = from.path;
    track->interpolation = from.interpolation;
    track->count = from.times.size();
    track->times = copy_floats(from.times);
    track->values = copy_floats(from.values);
    out->start_s = std::min(out->start_s, static_cast<double>(from.times.front()));
    out->stop_s = std::max(out->stop_s, static_cast<double>(from.times.back()));
  }
}

} // namespace

void build_nodes(const Asset &asset, const std::vector<Placed> &placed,
                 const std::vector<int> &order, pl_model *model) {
  pl_nodes *nodes = &model->nodes;
  nodes->items = allocate<pl_node>(placed.size(), "nodes");
  nodes->count = placed.size();
  nodes->order = allocate<int>(order.size(), "nodes");
  nodes->order_count = order.size();
  std::copy(order.begin(), order.end(), nodes->order);
  for (size_t i = 0; i < placed.size(); i++) {
    pl_node *node = &nodes->items[i];
    node->name = copy_text(name_of(asset.model, i));
    node->parent = placed[i].parent;
    node->local = turned(placed[i].local);
    node->has_matrix = asset.model.nodes[i].matrix.size() == 16;
    node->trs = trs_of(asset.model.nodes[i]);
  }
}

void build_animations(const Asset &asset, const json &animations, const std::vector<Placed> &placed,
                      pl_model *model, Warnings &warnings) {
  if (!animations.is_array())
    return;
  size_t budget = FREE_NUMBERS + asset.file_bytes;
  model->animations = allocate<pl_animation>(animations.size(), "animations");
  for (size_t i = 0; i < animations.size(); i++) {
    const std::string what = "animations[" + std::to_string(i) + "]";
    try {
      Reader reader(asset, animations[i], what, placed, budget);
      const std::vector<Track> tracks = reader.read();
      if (tracks.empty()) {
        warnings.add("%s is left out: it moves no node of the scene", what.c_str());
        continue;
      }
      if (reader.passed_over() > 0)
        warnings.add("%s: %zu channels move no node of the scene (weights, pointers) and are left "
                     "out",
                     what.c_str(), reader.passed_over());
      pl_animation *out = &model->animations[model->animation_count++];
      const auto name = animations[i].find("name");
      const bool named = name != animations[i].end() && name->is_string() && !name->empty();
      out->name = copy_text(named ? name->get<std::string>() : "animation " + std::to_string(i));
      fill_animation(tracks, out);
    } catch (const Fault &fault) {
      if (fault.status == PL_E_MEMORY)
        throw;
      warnings.add("%s is left out: %s", what.c_str(), fault.text.c_str());
    }
  }
}

} // namespace pl_gltf
