/* Extracts material graphs from the extras of a file's materials as text, without interpreting
 * them. */
#include <algorithm>
#include <exception>
#include <memory>
#include <new>
#include <vector>

#include "base/memory.h"
#include "io/gltf.h"
#include "io/gltf_guard.hpp"

namespace pl_gltf {

namespace {

using nlohmann::json;

const char KEY[] = "perilune_graph";
/* Limit on the text of all graphs of a file together. */
constexpr size_t MAX_TEXT = size_t{1} << 20;

bool holds_key(Bytes text) {
  const char *end = KEY + sizeof KEY - 1;
  const uint8_t *last = text.data + text.size;
  return std::search(text.data, last, KEY, end) != last;
}

std::vector<bool> used_materials(const json &document, size_t count) {
  std::vector<bool> used(count, false);
  for (const json &mesh : document.value("meshes", json::array()))
    for (const json &primitive : mesh.value("primitives", json::array())) {
      const int material = primitive.value("material", -1);
      if (material >= 0 && static_cast<size_t>(material) < count)
        used[static_cast<size_t>(material)] = true;
    }
  return used;
}

/* Names are the same as in build_materials. */
std::string graphs_of(const json &document) {
  const json materials = document.value("materials", json::array());
  const std::vector<bool> used = used_materials(document, materials.size());
  json out = json::array();
  for (size_t i = 0; i < materials.size(); i++) {
    const std::string name = materials[i].value("name", "");
    json row = {{"index", i}, {"name", name.empty() ? "material " + std::to_string(i) : name}};
    const auto extras = materials[i].find("extras");
    if (used[i] && extras != materials[i].end() && extras->is_object() && extras->contains(KEY))
      row["graph"] = (*extras)[KEY];
    out.push_back(row);
  }
  const std::string text = out.dump();
  if (text.size() > MAX_TEXT)
    fail(PL_E_RANGE, "materials: names and graphs (extras.%s) of more than %zu bytes", KEY,
         MAX_TEXT);
  return text;
}

std::string read_graphs(const char *path) {
  std::unique_ptr<Source> source;
  try {
    source = std::make_unique<Source>(path);
  } catch (const Fault &) {
    return "[]"; /* loading the file reports the error */
  }
  if (!holds_key(source->json()))
    return "[]";
  Warnings warnings;
  return graphs_of(parse_and_check(*source, warnings));
}

} // namespace

} // namespace pl_gltf

extern "C" pl_status pl_gltf_graphs(const char *path, char **out) {
  *out = nullptr;
  try {
    const std::string text = pl_gltf::read_graphs(path);
    *out = pl_strdup(text.c_str());
    return *out != nullptr ? PL_OK : pl_fail(PL_E_MEMORY, "%s: out of memory", path);
  } catch (const pl_gltf::Fault &fault) {
    return pl_fail(fault.status, "%s: %s", path, fault.text.c_str());
  } catch (const std::bad_alloc &) {
    return pl_fail(PL_E_MEMORY, "%s: out of memory", path);
  } catch (const std::exception &error) {
    return pl_fail(PL_E_FORMAT, "%s: %s", path, error.what());
  }
}
