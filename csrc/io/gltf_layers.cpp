/* The layers of glTF materials: KHR_materials_clearcoat, _transmission, _ior, _specular and
 * _anisotropy. Their factors are read; their maps are left out with a warning. */
#include <cmath>

#include "io/gltf_material.hpp"

namespace pl_gltf {

namespace {

/* One extension of one material. */
class Extension {
public:
  Extension(const tinygltf::Material &in, const char *extension, const std::string &name,
            Warnings &warnings)
      : name_(name + ": " + extension) {
    const auto it = in.extensions.find(extension);
    if (it == in.extensions.end() || !it->second.IsObject())
      return;
    value_ = &it->second;
    for (const std::string &key : value_->Keys())
      if (key.size() > 7 && key.compare(key.size() - 7, 7, "Texture") == 0)
        warnings.add("%s: %s is left out: the factors alone are read", name_.c_str(), key.c_str());
  }

  bool given() const { return value_ != nullptr; }

  float number(const char *key, double otherwise, double low, double high) const {
    return value_ == nullptr || !value_->Has(key) ? static_cast<float>(otherwise)
                                                  : checked(value_->Get(key), key, low, high);
  }

  void color(const char *key, float out[3]) const {
    if (value_ == nullptr || !value_->Has(key))
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

} // namespace

void read_layers(const tinygltf::Material &in, const std::string &name, Warnings &warnings,
                 pl_material *out) {
  const Extension coat(in, "KHR_materials_clearcoat", name, warnings);
  const Extension clear(in, "KHR_materials_transmission", name, warnings);
  const Extension ior(in, "KHR_materials_ior", name, warnings);
  const Extension specular(in, "KHR_materials_specular", name, warnings);
  const Extension anisotropy(in, "KHR_materials_anisotropy", name, warnings);
  pl_material_layers *layers = &out->layers;
  const double turn = 1e6; /* radians: any angle that a float still tells apart */
  *layers = PL_MATERIAL_LAYERS_PLAIN;
  layers->coat = coat.number("clearcoatFactor", 0.0, 0.0, 1.0);
  layers->coat_roughness = coat.number("clearcoatRoughnessFactor", 0.0, 0.0, 1.0);
  layers->transmission = clear.number("transmissionFactor", 0.0, 0.0, 1.0);
  layers->ior = ior.number("ior", 1.5, 0.0, 1e6);
  layers->specular = specular.number("specularFactor", 1.0, 0.0, 1.0);
  specular.color("specularColorFactor", layers->specular_color);
  layers->anisotropy = anisotropy.number("anisotropyStrength", 0.0, 0.0, 1.0);
  layers->anisotropy_rotation_rad = anisotropy.number("anisotropyRotation", 0.0, -turn, turn);
  if (layers->ior > 0.0f && layers->ior < 1.0f)
    fail(PL_E_FORMAT, "%s: ior must be 0 or at least 1", name.c_str());
  out->layered = layers->coat > 0.0f || layers->transmission > 0.0f || layers->anisotropy > 0.0f ||
                 ior.given() || specular.given();
}

} // namespace pl_gltf
