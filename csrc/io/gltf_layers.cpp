/* Layers of glTF materials: KHR_materials_clearcoat, _transmission, _volume, _ior, _specular and
 * _anisotropy. */
#include <algorithm>
#include <cmath>

#include "io/gltf_material.hpp"

namespace pl_gltf {

namespace {

/* One extension of one material. */
class Extension {
public:
  Extension(const tinygltf::Material &in, const char *extension, const std::string &name)
      : name_(name + ": " + extension) {
    const auto it = in.extensions.find(extension);
    if (it != in.extensions.end() && it->second.IsObject())
      value_ = &it->second;
  }

  bool given() const { return value_ != nullptr; }
  bool has(const char *key) const { return given() && value_->Has(key); }

  float number(const char *key, double otherwise, double low, double high) const {
    return has(key) ? checked(value_->Get(key), key, low, high) : static_cast<float>(otherwise);
  }

  void color(const char *key, float out[3]) const {
    if (!has(key))
      return;
    const tinygltf::Value &list = value_->Get(key);
    if (!list.IsArray() || list.ArrayLen() != 3)
      fail(PL_E_FORMAT, "%s: %s must be three numbers", name_.c_str(), key);
    for (int i = 0; i < 3; i++)
      out[i] = checked(list.Get(i), key, 0.0, 1e6);
  }

private:
  float checked(const tinygltf::Value &value, const char *key, double low, double high) const {
    const double number = value.IsNumber() ? value.GetNumberAsDouble() : NAN;
    if (!(number >= low && number <= high))
      fail(PL_E_FORMAT, "%s: %s must be a number from %g to %g", name_.c_str(), key, low, high);
    return static_cast<float>(number);
  }

  std::string name_;
  const tinygltf::Value *value_ = nullptr;
};

/* KHR_materials_volume: a non-zero thickness makes the mesh the boundary of a solid. The path
 * length inside follows from the mesh, not from the value of the thickness. The attenuation colour
 * is the transmittance over the attenuation distance. */
void read_volume(const tinygltf::Material &in, const std::string &name, double unit,
                 pl_material_layers *layers, Warnings &warnings) {
  const Extension volume(in, "KHR_materials_volume", name);
  /* lengths have arbitrary units: the limit is that of a float */
  const double darkest = 1e-6, never = 3e38;
  float color[3] = {1, 1, 1};
  layers->solid = volume.number("thicknessFactor", 0.0, 0.0, never) > 0.0f;
  volume.color("attenuationColor", color);
  if (*std::max_element(color, color + 3) > 1.0f)
    warnings.add("%s: KHR_materials_volume: attenuationColor is clamped to 0..1", name.c_str());
  if (volume.has("thicknessTexture"))
    warnings.add("%s: KHR_materials_volume: thicknessTexture is not read: the mesh says how thick "
                 "it is",
                 name.c_str());
  const float distance = volume.number("attenuationDistance", never, 1e-37, never);
  for (int k = 0; k < 3; k++)
    layers->extinction[k] = static_cast<float>(
        -std::log(std::min(std::max(static_cast<double>(color[k]), darkest), 1.0)) /
        static_cast<double>(distance) * unit);
}

} // namespace

void read_layers(const tinygltf::Material &in, const std::string &name, double unit,
                 pl_material *out, Warnings &warnings) {
  const Extension coat(in, "KHR_materials_clearcoat", name);
  const Extension clear(in, "KHR_materials_transmission", name);
  const Extension ior(in, "KHR_materials_ior", name);
  const Extension specular(in, "KHR_materials_specular", name);
  const Extension anisotropy(in, "KHR_materials_anisotropy", name);
  pl_material_layers *layers = &out->layers;
  const double turn = 1e6; /* radians: largest angle that a float still resolves */
  *layers = PL_MATERIAL_LAYERS_PLAIN;
  layers->coat = coat.number("clearcoatFactor", 0.0, 0.0, 1.0);
  layers->coat_roughness = coat.number("clearcoatRoughnessFactor", 0.0, 0.0, 1.0);
  layers->transmission = clear.number("transmissionFactor", 0.0, 0.0, 1.0);
  layers->ior = ior.number("ior", 1.5, 0.0, 1e6);
  layers->specular = specular.number("specularFactor", 1.0, 0.0, 1.0);
  specular.color("specularColorFactor", layers->specular_color);
  layers->anisotropy = anisotropy.number("anisotropyStrength", 0.0, 0.0, 1.0);
  layers->anisotropy_rotation_rad = anisotropy.number("anisotropyRotation", 0.0, -turn, turn);
  read_volume(in, name, unit, layers, warnings);
  if (layers->solid && layers->transmission > 0.0f)
    out->double_sided = true; /* light must be able to leave the solid */
  if (layers->ior > 0.0f && layers->ior < 1.0f)
    fail(PL_E_FORMAT, "%s: ior must be 0 or at least 1", name.c_str());
  out->layered = layers->coat > 0.0f || layers->transmission > 0.0f || layers->anisotropy > 0.0f ||
                 ior.given() || specular.given();
}

namespace {

/* A map of an extension, and the factor that disables it when 0. */
struct MapKey {
  const char *extension, *key, *factor;
  double factor_otherwise;
  bool srgb;
  pl_texture_slot pl_material_layers::*slot;
};

#define CLEARCOAT "KHR_materials_clearcoat"
#define SPECULAR "KHR_materials_specular"
const MapKey map_keys[] = {
    {CLEARCOAT, "clearcoatTexture", "clearcoatFactor", 0, false, &pl_material_layers::coat_map},
    {CLEARCOAT, "clearcoatRoughnessTexture", "clearcoatRoughnessFactor", 0, false,
     &pl_material_layers::coat_roughness_map},
    {CLEARCOAT, "clearcoatNormalTexture", "clearcoatFactor", 0, false,
     &pl_material_layers::coat_normal_map},
    {"KHR_materials_transmission", "transmissionTexture", "transmissionFactor", 0, false,
     &pl_material_layers::transmission_map},
    {SPECULAR, "specularTexture", "specularFactor", 1, false, &pl_material_layers::specular_map},
    {SPECULAR, "specularColorTexture", "specularFactor", 1, true,
     &pl_material_layers::specular_color_map},
    {"KHR_materials_anisotropy", "anisotropyTexture", "anisotropyStrength", 0, false,
     &pl_material_layers::anisotropy_map},
};
#undef CLEARCOAT
#undef SPECULAR

double number_or(const tinygltf::Value &object, const char *key, double otherwise) {
  return object.Has(key) ? object.Get(key).GetNumberAsDouble() : otherwise;
}

/* Precondition, checked by check_schema: types are valid. */
tinygltf::NormalTextureInfo texture_info(const tinygltf::Value &value) {
  tinygltf::NormalTextureInfo info;
  info.index = value.Get("index").GetNumberAsInt();
  info.texCoord = static_cast<int>(number_or(value, "texCoord", 0));
  info.scale = number_or(value, "scale", 1);
  if (value.Has("extensions"))
    for (const std::string &name : value.Get("extensions").Keys())
      info.extensions.emplace(name, value.Get("extensions").Get(name));
  return info;
}

} // namespace

std::vector<LayerMap> layer_maps(const tinygltf::Material &in) {
  std::vector<LayerMap> out;
  for (const MapKey &key : map_keys) {
    const auto it = in.extensions.find(key.extension);
    if (it == in.extensions.end() || !it->second.Has(key.key) ||
        !(number_or(it->second, key.factor, key.factor_otherwise) > 0.0))
      continue;
    out.push_back({std::string(key.extension) + "." + key.key, key.srgb, key.slot,
                   texture_info(it->second.Get(key.key))});
  }
  return out;
}

bool is_anisotropic(const tinygltf::Material &in) {
  const auto it = in.extensions.find("KHR_materials_anisotropy");
  return it != in.extensions.end() && number_or(it->second, "anisotropyStrength", 0) > 0.0;
}

} // namespace pl_gltf
