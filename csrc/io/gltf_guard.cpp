/* Validation before tinygltf: JSON text, version, extensions, node hierarchy, buffers. */
#include "io/gltf_guard.hpp"

#include <algorithm>
#include <cstring>
#include <set>

namespace pl_gltf {

namespace {

using nlohmann::json;

/* Largest nesting depth of the text. glTF itself needs about ten levels; the rest is for
 * `extras`. */
constexpr int MAX_JSON_DEPTH = 100;
/* Largest number of nodes from the root to a leaf. */
constexpr int MAX_NODE_DEPTH = 1000;

/* Extensions that the reader implements, and those that it may ignore although a file requires
 * them. */
const char *const implemented[] = {
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_materials_unlit",
    "KHR_materials_emissive_strength",
    "KHR_materials_clearcoat",
    "KHR_materials_transmission",
    "KHR_materials_ior",
    "KHR_materials_specular",
    "KHR_materials_anisotropy",
    "KHR_materials_volume",
};
const char *const ignorable[] = {"KHR_lights_punctual", "KHR_xmp", "KHR_xmp_json_ld"};

template <size_t N> bool contains(const char *const (&list)[N], const std::string &name) {
  return std::any_of(list, list + N, [&](const char *known) { return name == known; });
}

/* The parsers recurse to the nesting depth, so it is checked before they read the text. */
void check_depth(Bytes text) {
  int depth = 0;
  bool quoted = false;
  for (size_t i = 0; i < text.size; i++) {
    const uint8_t c = text.data[i];
    if (quoted) {
      if (c == '\\')
        i++;
      else if (c == '"')
        quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if (c == '{' || c == '[') {
      if (++depth > MAX_JSON_DEPTH)
        fail(PL_E_FORMAT, "JSON nested deeper than %d", MAX_JSON_DEPTH);
    } else if (c == '}' || c == ']') {
      depth--;
    }
  }
}

json parse(Bytes text) {
  if (text.size == 0)
    fail(PL_E_FORMAT, "empty: there is no JSON");
  check_depth(text);
  try {
    json document = json::parse(text.data, text.data + text.size);
    if (!document.is_object())
      fail(PL_E_FORMAT, "the JSON is not an object");
    return document;
  } catch (const json::exception &error) {
    fail(PL_E_FORMAT, "broken JSON: %s", printable(error.what()).c_str());
  }
}

void check_version(const json &document) {
  const auto asset = document.find("asset");
  if (asset == document.end() || !asset->is_object() || !asset->contains("version") ||
      !(*asset)["version"].is_string())
    fail(PL_E_FORMAT, "asset.version: is missing; only glTF 2.0 is read");
  for (const char *key : {"version", "minVersion"}) {
    const auto value = asset->find(key);
    if (value == asset->end())
      continue;
    const std::string version = value->is_string() ? value->get<std::string>() : "";
    const bool two = version.compare(0, 2, "2.") == 0 && version.size() > 2 &&
                     version.find_first_not_of("0123456789", 2) == std::string::npos;
    if (!two || (strcmp(key, "minVersion") == 0 && version != "2.0"))
      fail(PL_E_UNSUPPORTED, "asset.%s: \"%s\"; only glTF 2.0 is read", key,
           printable(version).c_str());
  }
}

std::vector<std::string> names(const json &document, const char *key) {
  std::vector<std::string> out;
  const auto it = document.find(key);
  if (it == document.end())
    return out;
  if (!it->is_array())
    fail(PL_E_FORMAT, "%s: must be an array", key);
  for (const json &name : *it) {
    if (!name.is_string())
      fail(PL_E_FORMAT, "%s: must hold strings", key);
    out.push_back(name.get<std::string>());
  }
  return out;
}

/* Adds the names of all extensions of a value and its descendants; the content of `extras` is
 * skipped, as it is arbitrary. The recursion is bounded by the depth of the text. */
void collect_extensions(const json &value, std::set<std::string> &out) {
  if (value.is_object()) {
    const auto extensions = value.find("extensions");
    if (extensions != value.end() && extensions->is_object())
      for (auto it = extensions->begin(); it != extensions->end(); ++it)
        out.insert(it.key());
    for (auto it = value.begin(); it != value.end(); ++it)
      if (it.key() != "extras")
        collect_extensions(it.value(), out);
  } else if (value.is_array() && !value.empty() && value.front().is_structured()) {
    for (const json &item : value)
      collect_extensions(item, out);
  }
}

void check_extensions(const json &document, Warnings &warnings) {
  const std::vector<std::string> required = names(document, "extensionsRequired");
  std::string refused;
  for (const std::string &name : required)
    if (!contains(implemented, name) && !contains(ignorable, name))
      refused += (refused.empty() ? "" : ", ") + printable(name);
  if (!refused.empty())
    fail(PL_E_UNSUPPORTED, "requires %s, which is not supported", refused.c_str());
  const std::vector<std::string> used = names(document, "extensionsUsed");
  std::set<std::string> there(used.begin(), used.end());
  collect_extensions(document, there); /* also finds extensions that the file does not declare */
  for (const std::string &name : there)
    if (!contains(implemented, name))
      warnings.add("extension %s is not supported and ignored", printable(name).c_str());
}

/* Checks that the hierarchy is a forest: each node has at most one parent and is reachable from a
 * root. */
void check_hierarchy(const json &document) {
  const auto nodes = document.find("nodes");
  if (nodes == document.end())
    return;
  std::vector<int> parent(nodes->size(), -1);
  for (size_t i = 0; i < nodes->size(); i++) {
    const auto children = (*nodes)[i].find("children");
    if (children == (*nodes)[i].end())
      continue;
    for (const json &child : *children) {
      const size_t c = child.get<size_t>();
      if (parent[c] >= 0)
        fail(PL_E_FORMAT, "nodes[%zu] has two parents, nodes[%d] and nodes[%zu]", c, parent[c], i);
      parent[c] = static_cast<int>(i);
    }
  }
  /* A chain of parents longer than the number of nodes is a cycle. Depths are cached, so that all
   * chains together take linear time. */
  std::vector<int> depth(nodes->size(), 0);
  for (size_t i = 0; i < nodes->size(); i++) {
    std::vector<size_t> chain;
    size_t n = i;
    while (depth[n] == 0 && parent[n] >= 0 && chain.size() <= nodes->size()) {
      chain.push_back(n);
      n = static_cast<size_t>(parent[n]);
    }
    if (chain.size() > nodes->size())
      fail(PL_E_FORMAT, "nodes[%zu] is in a cycle of nodes", n);
    int d = depth[n] = std::max(depth[n], 1);
    while (!chain.empty()) {
      depth[chain.back()] = ++d;
      chain.pop_back();
    }
    if (d > MAX_NODE_DEPTH)
      fail(PL_E_FORMAT, "nodes[%zu] lies deeper than %d nodes", i, MAX_NODE_DEPTH);
  }
}

void warn_of_the_ignored(const json &document, Warnings &warnings) {
  const auto has = [&](const char *key) {
    const auto it = document.find(key);
    return it != document.end() && it->is_array() && !it->empty();
  };
  if (has("skins"))
    warnings.add("skins are ignored: meshes are placed by their nodes");
  if (has("cameras"))
    warnings.add("cameras are ignored");
  for (size_t i = 0; has("nodes") && i < document["nodes"].size(); i++) {
    const json &node = document["nodes"][i];
    if (node.contains("matrix") &&
        (node.contains("translation") || node.contains("rotation") || node.contains("scale")))
      warnings.add("nodes[%zu] has a matrix beside translation, rotation or scale, which glTF "
                   "forbids: the matrix counts",
                   i);
  }
  const auto scenes = document.find("scenes");
  if (scenes != document.end() && scenes->size() > 1)
    warnings.add("scenes[%d] is read, the %zu others are left out", document.value("scene", 0),
                 scenes->size() - 1);
}

/* A fallback buffer for readers without EXT_meshopt_compression: nothing is read from it here. */
bool is_fallback(const json &buffer) {
  const auto extensions = buffer.find("extensions");
  if (extensions == buffer.end())
    return false;
  const auto it = extensions->find("EXT_meshopt_compression");
  return it != extensions->end() && it->is_object() && it->value("fallback", json()) == true;
}

} // namespace

json parse_and_check(const Source &source, Warnings &warnings) {
  json document = parse(source.json());
  check_version(document);
  check_extensions(document, warnings);
  check_schema(document);
  check_hierarchy(document);
  warn_of_the_ignored(document, warnings);
  return document;
}

std::vector<Bytes> load_buffers(const json &document, Source &source) {
  std::vector<Bytes> out;
  const auto buffers = document.find("buffers");
  for (size_t i = 0; buffers != document.end() && i < buffers->size(); i++) {
    const json &buffer = (*buffers)[i];
    const std::string what = "buffers[" + std::to_string(i) + "]";
    const size_t length = buffer["byteLength"].get<size_t>();
    Bytes bytes;
    if (is_fallback(buffer)) {
      out.push_back(bytes);
      continue;
    }
    if (buffer.contains("uri"))
      bytes = source.resolve(buffer["uri"].get_ref<const std::string &>(), what);
    else if (i == 0 && source.binary())
      bytes = source.binary_chunk();
    /* A buffer without content is an error only when something is read from it. */
    if ((bytes.data != nullptr || buffer.contains("uri")) && bytes.size < length)
      fail(PL_E_FORMAT, "%s: byteLength is %zu, but only %zu bytes are there", what.c_str(), length,
           bytes.size);
    out.push_back({bytes.data, std::min(bytes.size, length)});
  }
  return out;
}

std::vector<ImageRef> load_images(const json &document, Source &source) {
  std::vector<ImageRef> out;
  const auto images = document.find("images");
  for (size_t i = 0; images != document.end() && i < images->size(); i++) {
    const json &image = (*images)[i];
    ImageRef ref;
    ref.name = "images[" + std::to_string(i) + "]";
    if (image.contains("name"))
      ref.name += " \"" + printable(image["name"].get<std::string>()) + "\"";
    ref.view = image.value("bufferView", -1);
    if (image.contains("uri"))
      ref.file = source.resolve(image["uri"].get_ref<const std::string &>(), ref.name);
    out.push_back(ref);
  }
  return out;
}

int strip_for_parser(json &document) {
  const auto textures = document.find("textures");
  for (size_t i = 0; textures != document.end() && i < textures->size(); i++) {
    const auto extensions = (*textures)[i].find("extensions");
    if (extensions != (*textures)[i].end() && extensions->contains("EXT_texture_webp"))
      (*textures)[i]["source"] = json((*extensions)["EXT_texture_webp"]["source"]);
  }
  for (const char *key : {"buffers", "images", "animations", "skins", "cameras", "extras",
                          "extensions", "extensionsUsed", "extensionsRequired"})
    document.erase(key);
  json &views = document["bufferViews"];
  if (!views.is_array())
    views = json::array();
  const size_t none = views.size();
  views.push_back({{"buffer", 0}, {"byteLength", 1}});
  const auto accessors = document.find("accessors");
  for (size_t i = 0; accessors != document.end() && i < accessors->size(); i++)
    if (!(*accessors)[i].contains("bufferView"))
      (*accessors)[i]["bufferView"] = none;
  return static_cast<int>(none);
}

} // namespace pl_gltf
