/* Checks types and ranges of the properties of a glTF document that the reader uses (glTF 2.0,
 * section 5). */
#include <climits>
#include <cmath>
#include <utility>
#include <vector>

#include "io/gltf_guard.hpp"

namespace pl_gltf {

namespace {

using nlohmann::json;

/* Larger integers are not exact as doubles, so no JSON number should be one. */
constexpr int64_t MAX_INTEGER = int64_t{1} << 53;

/* A JSON object and its path in the file, for error texts. */
class Object {
public:
  Object(json &value, std::string path) : value_(value), path_(std::move(path)) {
    if (!value_.is_object())
      fail(PL_E_FORMAT, "%s: must be an object", path_.c_str());
  }

  json *find(const char *key) {
    const auto it = value_.find(key);
    return it == value_.end() ? nullptr : &*it;
  }
  std::string at(const char *key) const { return path_.empty() ? key : path_ + "." + key; }

  void integer(const char *key, int64_t low, int64_t high, bool required = false) {
    if (json *value = need(key, required))
      check_integer(*value, at(key), low, high);
  }
  /* Precondition: the integer has passed its check. */
  void multiple(const char *key, int of) {
    const json *value = find(key);
    if (value != nullptr && value->get<int64_t>() % of != 0)
      fail(PL_E_FORMAT, "%s: %lld is no multiple of %d", at(key).c_str(), value->get<long long>(),
           of);
  }
  void index(const char *key, size_t count, const char *of, bool required = false) {
    if (json *value = need(key, required))
      check_index(*value, at(key), count, of);
  }
  void number(const char *key) {
    if (json *value = find(key))
      if (!value->is_number() || !std::isfinite(value->get<double>()))
        fail(PL_E_FORMAT, "%s: must be a finite number", at(key).c_str());
  }
  void numbers(const char *key, size_t count) {
    json *value = find(key);
    if (value == nullptr)
      return;
    bool good = value->is_array() && value->size() == count;
    for (size_t i = 0; good && i < count; i++)
      good = (*value)[i].is_number() && std::isfinite((*value)[i].get<double>());
    if (!good)
      fail(PL_E_FORMAT, "%s: must be %zu finite numbers", at(key).c_str(), count);
  }
  void text(const char *key, bool required = false) {
    const json *value = need(key, required);
    if (value != nullptr && !value->is_string())
      fail(PL_E_FORMAT, "%s: must be a string", at(key).c_str());
  }
  void boolean(const char *key) {
    const json *value = find(key);
    if (value != nullptr && !value->is_boolean())
      fail(PL_E_FORMAT, "%s: must be true or false", at(key).c_str());
  }
  void one_of(const char *key, std::initializer_list<const char *> allowed, bool required = false) {
    text(key, required);
    const json *value = find(key);
    if (value == nullptr)
      return;
    std::string list;
    for (const char *name : allowed) {
      if (*value == name)
        return;
      list += (list.empty() ? "" : ", ") + std::string(name);
    }
    fail(PL_E_FORMAT, "%s: \"%s\" is none of %s", at(key).c_str(),
         printable(value->get<std::string>()).c_str(), list.c_str());
  }
  void one_of(const char *key, std::initializer_list<int> allowed, bool required = false) {
    integer(key, 0, INT_MAX, required);
    const json *value = find(key);
    if (value == nullptr)
      return;
    std::string list;
    for (const int number : allowed) {
      if (*value == number)
        return;
      list += (list.empty() ? "" : ", ") + std::to_string(number);
    }
    fail(PL_E_FORMAT, "%s: %d is none of %s", at(key).c_str(), value->get<int>(), list.c_str());
  }
  void indices(const char *key, size_t count, const char *of) {
    json *value = find(key);
    if (value == nullptr)
      return;
    if (!value->is_array())
      fail(PL_E_FORMAT, "%s: must be an array", at(key).c_str());
    for (size_t i = 0; i < value->size(); i++)
      check_index((*value)[i], at(key) + "[" + std::to_string(i) + "]", count, of);
  }

  static void check_index(json &value, const std::string &path, size_t count, const char *of) {
    check_integer(value, path, 0, INT_MAX);
    if (value.get<size_t>() >= count)
      fail(PL_E_FORMAT, "%s: %lld, but the file has %zu %s", path.c_str(), value.get<long long>(),
           count, of);
  }

private:
  json *need(const char *key, bool required) {
    json *value = find(key);
    if (value == nullptr && required)
      fail(PL_E_FORMAT, "%s: is missing", at(key).c_str());
    return value;
  }
  /* A float with an integral value counts as an integer (JSON Schema); it is converted, as tinygltf
   * requires integers. */
  static void check_integer(json &value, const std::string &path, int64_t low, int64_t high) {
    if (value.is_number_float()) {
      const double number = value.get<double>();
      if (std::floor(number) == number && std::fabs(number) <= static_cast<double>(MAX_INTEGER))
        value = static_cast<int64_t>(number);
    }
    bool good = value.is_number_integer();
    if (good && value.is_number_unsigned())
      good = value.get<uint64_t>() <= static_cast<uint64_t>(high);
    good = good && value.get<int64_t>() >= low && value.get<int64_t>() <= high;
    if (!good)
      fail(PL_E_FORMAT, "%s: must be an integer in %lld..%lld", path.c_str(),
           static_cast<long long>(low), static_cast<long long>(high));
  }

  json &value_;
  std::string path_;
};

/* Lengths of the top-level arrays. */
struct Counts {
  size_t accessors, buffers, views, images, materials, meshes, nodes, samplers, scenes, textures;
};

size_t count_of(const json &document, const char *key) {
  const auto it = document.find(key);
  if (it == document.end())
    return 0;
  if (!it->is_array())
    fail(PL_E_FORMAT, "%s: must be an array", key);
  return it->size();
}

/* Calls `check` for every object of a top-level array. */
template <typename Check> void each(json &document, const char *key, const Check &check) {
  const auto it = document.find(key);
  for (size_t i = 0; it != document.end() && i < it->size(); i++)
    check(Object((*it)[i], std::string(key) + "[" + std::to_string(i) + "]"));
}

void check_sparse(Object accessor, const Counts &n) {
  json *value = accessor.find("sparse");
  if (value == nullptr)
    return;
  Object sparse(*value, accessor.at("sparse"));
  sparse.integer("count", 1, INT_MAX, true);
  if (sparse.find("indices") == nullptr || sparse.find("values") == nullptr)
    fail(PL_E_FORMAT, "%s: needs indices and values", accessor.at("sparse").c_str());
  Object indices(*sparse.find("indices"), sparse.at("indices"));
  indices.index("bufferView", n.views, "bufferViews", true);
  indices.integer("byteOffset", 0, INT_MAX);
  indices.one_of("componentType", {5121, 5123, 5125}, true);
  Object values(*sparse.find("values"), sparse.at("values"));
  values.index("bufferView", n.views, "bufferViews", true);
  values.integer("byteOffset", 0, INT_MAX);
}

void check_meshopt(Object view, const Counts &n) {
  json *extensions = view.find("extensions");
  if (extensions == nullptr)
    return;
  Object all(*extensions, view.at("extensions"));
  json *value = all.find("EXT_meshopt_compression");
  if (value == nullptr)
    return;
  Object meshopt(*value, all.at("EXT_meshopt_compression"));
  meshopt.index("buffer", n.buffers, "buffers", true);
  meshopt.integer("byteOffset", 0, INT_MAX);
  meshopt.integer("byteLength", 1, INT_MAX, true);
  meshopt.integer("byteStride", 2, 256, true);
  meshopt.integer("count", 1, INT_MAX, true);
  meshopt.one_of("mode", {"ATTRIBUTES", "TRIANGLES", "INDICES"}, true);
  meshopt.one_of("filter", {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"});
}

void check_data(json &document, const Counts &n) {
  each(document, "buffers", [](Object o) {
    o.integer("byteLength", 1, MAX_INTEGER, true);
    o.text("uri");
    if (json *value = o.find("extensions"))
      Object(*value, o.at("extensions"));
  });
  each(document, "bufferViews", [&](Object o) {
    o.index("buffer", n.buffers, "buffers", true);
    o.integer("byteOffset", 0, MAX_INTEGER);
    o.integer("byteLength", 1, MAX_INTEGER, true);
    o.integer("byteStride", 4, 252);
    o.multiple("byteStride", 4);
    check_meshopt(o, n);
  });
  each(document, "accessors", [&](Object o) {
    o.index("bufferView", n.views, "bufferViews");
    o.integer("byteOffset", 0, MAX_INTEGER);
    o.integer("count", 1, MAX_INTEGER, true);
    o.boolean("normalized");
    o.one_of("componentType", {5120, 5121, 5122, 5123, 5125, 5126}, true);
    o.one_of("type", {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"}, true);
    check_sparse(o, n);
  });
}

void check_draco(Object primitive, const Counts &n) {
  json *extensions = primitive.find("extensions");
  if (extensions == nullptr)
    return;
  Object all(*extensions, primitive.at("extensions"));
  json *value = all.find("KHR_draco_mesh_compression");
  if (value == nullptr)
    return;
  Object draco(*value, all.at("KHR_draco_mesh_compression"));
  draco.index("bufferView", n.views, "bufferViews", true);
  json *attributes = draco.find("attributes");
  if (attributes == nullptr)
    fail(PL_E_FORMAT, "%s: is missing", draco.at("attributes").c_str());
  Object ids(*attributes, draco.at("attributes"));
  for (auto it = attributes->begin(); it != attributes->end(); ++it)
    ids.integer(it.key().c_str(), 0, INT_MAX);
}

void check_primitive(json &value, const std::string &path, const Counts &n) {
  Object o(value, path);
  o.index("indices", n.accessors, "accessors");
  o.index("material", n.materials, "materials");
  o.integer("mode", 0, 6);
  check_draco(o, n);
  /* A primitive without attributes draws nothing; tinygltf would drop it, which shifts the indices
   * of the others. */
  if (o.find("attributes") == nullptr)
    value["attributes"] = json::object();
  json &attributes = value["attributes"];
  if (!attributes.is_object())
    fail(PL_E_FORMAT, "%s: must be an object", o.at("attributes").c_str());
  for (auto it = attributes.begin(); it != attributes.end(); ++it)
    Object::check_index(it.value(), o.at("attributes") + "." + printable(it.key()), n.accessors,
                        "accessors");
}

void check_meshes(json &document, const Counts &n) {
  each(document, "meshes", [&](Object o) {
    o.text("name");
    json *primitives = o.find("primitives");
    if (primitives == nullptr || !primitives->is_array() || primitives->empty())
      fail(PL_E_FORMAT, "%s: must be an array of at least one primitive",
           o.at("primitives").c_str());
    for (size_t i = 0; i < primitives->size(); i++)
      check_primitive((*primitives)[i], o.at("primitives") + "[" + std::to_string(i) + "]", n);
  });
}

void check_nodes(json &document, const Counts &n) {
  each(document, "nodes", [&](Object o) {
    o.text("name");
    o.index("mesh", n.meshes, "meshes");
    o.indices("children", n.nodes, "nodes");
    o.numbers("matrix", 16);
    o.numbers("translation", 3);
    o.numbers("rotation", 4);
    o.numbers("scale", 3);
  });
  each(document, "scenes", [&](Object o) { o.indices("nodes", n.nodes, "nodes"); });
}

void check_transform(Object info) {
  json *extensions = info.find("extensions");
  if (extensions == nullptr)
    return;
  Object all(*extensions, info.at("extensions"));
  json *value = all.find("KHR_texture_transform");
  if (value == nullptr)
    return;
  Object transform(*value, all.at("KHR_texture_transform"));
  transform.numbers("offset", 2);
  transform.numbers("scale", 2);
  transform.number("rotation");
  transform.integer("texCoord", 0, INT_MAX);
}

void check_slot(Object owner, const char *key, const Counts &n) {
  json *value = owner.find(key);
  if (value == nullptr)
    return;
  Object info(*value, owner.at(key));
  info.index("index", n.textures, "textures", true);
  info.integer("texCoord", 0, INT_MAX);
  info.number("scale");
  check_transform(info);
}

/* Maps of the extensions that gltf_layers.cpp reads. */
void check_layers(Object extensions, const Counts &n) {
  static const std::pair<const char *, std::vector<const char *>> known[] = {
      {"KHR_materials_clearcoat",
       {"clearcoatTexture", "clearcoatRoughnessTexture", "clearcoatNormalTexture"}},
      {"KHR_materials_transmission", {"transmissionTexture"}},
      {"KHR_materials_specular", {"specularTexture", "specularColorTexture"}},
      {"KHR_materials_anisotropy", {"anisotropyTexture"}},
      {"KHR_materials_ior", {}},
      {"KHR_materials_volume", {}},
      {"KHR_materials_unlit", {}},
      {"KHR_materials_emissive_strength", {}},
  };
  for (const auto &[name, maps] : known) {
    json *value = extensions.find(name);
    if (value == nullptr)
      continue;
    const Object extension(*value, extensions.at(name));
    for (const char *map : maps)
      check_slot(extension, map, n);
  }
}

void check_materials(json &document, const Counts &n) {
  each(document, "materials", [&](Object o) {
    o.text("name");
    o.numbers("emissiveFactor", 3);
    o.one_of("alphaMode", {"OPAQUE", "MASK", "BLEND"});
    o.number("alphaCutoff");
    o.boolean("doubleSided");
    for (const char *key : {"normalTexture", "occlusionTexture", "emissiveTexture"})
      check_slot(o, key, n);
    if (json *value = o.find("pbrMetallicRoughness")) {
      Object pbr(*value, o.at("pbrMetallicRoughness"));
      pbr.numbers("baseColorFactor", 4);
      pbr.number("metallicFactor");
      pbr.number("roughnessFactor");
      check_slot(pbr, "baseColorTexture", n);
      check_slot(pbr, "metallicRoughnessTexture", n);
    }
    if (json *value = o.find("extensions"))
      check_layers(Object(*value, o.at("extensions")), n);
  });
}

void check_webp(Object texture, const Counts &n) {
  json *extensions = texture.find("extensions");
  if (extensions == nullptr)
    return;
  Object all(*extensions, texture.at("extensions"));
  if (json *value = all.find("EXT_texture_webp"))
    Object(*value, all.at("EXT_texture_webp")).index("source", n.images, "images", true);
}

void check_textures(json &document, const Counts &n) {
  each(document, "images", [&](Object o) {
    o.text("name");
    o.text("uri");
    o.index("bufferView", n.views, "bufferViews");
    if ((o.find("uri") == nullptr) == (o.find("bufferView") == nullptr))
      fail(PL_E_FORMAT, "%s: must be given, or else bufferView; not both", o.at("uri").c_str());
  });
  each(document, "samplers", [](Object o) {
    o.one_of("wrapS", {10497, 33071, 33648});
    o.one_of("wrapT", {10497, 33071, 33648});
  });
  each(document, "textures", [&](Object o) {
    o.index("source", n.images, "images");
    o.index("sampler", n.samplers, "samplers");
    check_webp(o, n);
  });
}

} // namespace

void check_schema(json &document) {
  const Counts n = {count_of(document, "accessors"),   count_of(document, "buffers"),
                    count_of(document, "bufferViews"), count_of(document, "images"),
                    count_of(document, "materials"),   count_of(document, "meshes"),
                    count_of(document, "nodes"),       count_of(document, "samplers"),
                    count_of(document, "scenes"),      count_of(document, "textures")};
  Object root(document, "");
  root.index("scene", n.scenes, "scenes");
  check_data(document, n);
  check_meshes(document, n);
  check_nodes(document, n);
  check_textures(document, n);
  check_materials(document, n);
}

} // namespace pl_gltf
