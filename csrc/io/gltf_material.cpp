/* Materials and textures (glTF 2.0, sections 3.8 and 3.9). Occlusion maps are not read: path
 * tracing computes the effect that they approximate. Sampler filters are not read:
 * `render.texture_filter` selects the texture filter. */
#include "io/gltf_material.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include "base/memory.h"
#include "io/image_file.h"

namespace pl_gltf {

namespace {

/* Limits on the texels of all images of a model together: the limit of one image, and FREE_TEXELS
 * plus TEXELS_PER_BYTE per byte of the file (images of one colour compress to a few bytes). */
constexpr uint64_t MAX_TEXELS = uint64_t{1} << 28;
constexpr uint64_t FREE_TEXELS = uint64_t{1} << 24, TEXELS_PER_BYTE = 4096;

const pl_texture_slot NO_TEXTURE = {-1, 0, {{{1, 0, 0}, {0, 1, 0}}}};

struct TextureKey {
  int image;
  bool srgb;
  pl_wrap wrap_u, wrap_v;
  bool operator<(const TextureKey &o) const {
    return std::tie(image, srgb, wrap_u, wrap_v) < std::tie(o.image, o.srgb, o.wrap_u, o.wrap_v);
  }
};

void check(pl_status status) {
  if (status != PL_OK)
    fail(status, "%s", pl_error_text());
}

const tinygltf::Value *transform_of(const tinygltf::ExtensionMap &extensions) {
  const auto it = extensions.find("KHR_texture_transform");
  return it == extensions.end() || !it->second.IsObject() ? nullptr : &it->second;
}

int uv_set_of(int texcoord, const tinygltf::ExtensionMap &extensions) {
  const tinygltf::Value *transform = transform_of(extensions);
  return transform != nullptr && transform->Has("texCoord")
             ? transform->Get("texCoord").GetNumberAsInt()
             : texcoord;
}

/* KHR_texture_transform: uv' = translation * rotation * scale * uv, where the rotation is clockwise
 * in the v-down plane: u' = c u + s v, v' = -s u + c v. */
pl_uv_transform uv_transform(const tinygltf::ExtensionMap &extensions) {
  const tinygltf::Value *value = transform_of(extensions);
  double offset[2] = {0, 0}, scale[2] = {1, 1}, angle = 0;
  for (int i = 0; value != nullptr && i < 2; i++) {
    if (value->Has("offset"))
      offset[i] = value->Get("offset").Get(i).GetNumberAsDouble();
    if (value->Has("scale"))
      scale[i] = value->Get("scale").Get(i).GetNumberAsDouble();
  }
  if (value != nullptr && value->Has("rotation"))
    angle = value->Get("rotation").GetNumberAsDouble();
  const double c = std::cos(angle), s = std::sin(angle);
  return {{{static_cast<float>(c * scale[0]), static_cast<float>(s * scale[1]),
            static_cast<float>(offset[0])},
           {static_cast<float>(-s * scale[0]), static_cast<float>(c * scale[1]),
            static_cast<float>(offset[1])}}};
}

pl_wrap wrap_of(int gl) {
  return gl == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? PL_WRAP_CLAMP
         : gl == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? PL_WRAP_MIRROR
                                                       : PL_WRAP_REPEAT;
}

/* Use of a normal map, which is undone when its image does not contain normals. */
struct NormalUse {
  std::string what;
  pl_texture_slot *slot;
};

class MaterialBuilder {
public:
  MaterialBuilder(const Asset &asset, pl_model *model, Warnings &warnings)
      : asset_(asset), model_(model), warnings_(warnings) {}

  void build(const tinygltf::Material &in, const std::string &name, bool used, pl_material *out);
  void decode_textures();

private:
  template <typename Info>
  pl_texture_slot slot(const Info &info, bool srgb, const std::string &what);
  void note_normals(const std::string &what, pl_texture_slot *slot);
  void check_normals(int texture, const pl_image &image);
  float unit(double value, const std::string &what);

  const Asset &asset_;
  pl_model *model_;
  Warnings &warnings_;
  std::map<TextureKey, int> textures_;
  std::vector<NormalUse> normals_;
};

/* Returns the RMS deviation from 1 of the lengths of an image's vectors; it is small for a normal
 * map. */
double length_error(const pl_image &image) {
  const size_t channels = static_cast<size_t>(image.channels);
  const size_t texels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  double sum = 0.0;
  for (size_t i = 0; i < texels; i++) {
    double length2 = 0.0;
    for (size_t c = 0; c < 3; c++) {
      const double x = image.texels[i * channels + (channels < 3 ? 0 : c)] / 127.5 - 1.0;
      length2 += x * x;
    }
    const double error = std::sqrt(length2) - 1.0;
    sum += error * error;
  }
  return std::sqrt(sum / static_cast<double>(texels));
}

void MaterialBuilder::note_normals(const std::string &what, pl_texture_slot *slot) {
  if (slot->texture >= 0)
    normals_.push_back({what, slot});
}

/* Published normal maps deviate by 0.02 to 0.05 due to quantisation and compression; colour images
 * used as normal maps by mistake deviate by 0.4 and more. Read as normals, these tilt the surface
 * by some 50 degrees in a random direction per texel, which gives noise at any number of
 * samples. */
void MaterialBuilder::check_normals(int texture, const pl_image &image) {
  static const double ERROR_MAX = 0.3;
  static const int64_t TEXELS_MIN = 64; /* smaller images have only a colour or a few */
  if (static_cast<int64_t>(image.width) * image.height < TEXELS_MIN)
    return;
  bool measured = false;
  double error = 0.0;
  for (NormalUse &use : normals_) {
    if (use.slot->texture != texture)
      continue;
    error = measured ? error : length_error(image);
    measured = true;
    if (!(error > ERROR_MAX))
      return;
    warnings_.add("%s: a picture, not a map of normals, is left out: the lengths of its vectors "
                  "are off by %.2g (rms; normals have length 1)",
                  use.what.c_str(), error);
    *use.slot = NO_TEXTURE;
  }
}

template <typename Info>
pl_texture_slot MaterialBuilder::slot(const Info &info, bool srgb, const std::string &what) {
  if (info.index < 0)
    return NO_TEXTURE;
  const tinygltf::Texture &texture = asset_.model.textures.at(static_cast<size_t>(info.index));
  const int set = uv_set_of(info.texCoord, info.extensions);
  if (texture.source < 0) {
    warnings_.add("%s: textures[%d] has no image that can be read and is left out", what.c_str(),
                  info.index);
    return NO_TEXTURE;
  }
  if (set > 1 || model_->uvs[set] == nullptr) {
    warnings_.add("%s: there is no TEXCOORD_%d%s, the map is left out", what.c_str(), set,
                  set > 1 ? " (0 and 1 are read)" : "");
    return NO_TEXTURE;
  }
  TextureKey key = {texture.source, srgb, PL_WRAP_REPEAT, PL_WRAP_REPEAT};
  if (texture.sampler >= 0) {
    const tinygltf::Sampler &sampler =
        asset_.model.samplers.at(static_cast<size_t>(texture.sampler));
    key.wrap_u = wrap_of(sampler.wrapS);
    key.wrap_v = wrap_of(sampler.wrapT);
    if (sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST)
      warnings_.add("samplers[%d].magFilter NEAREST is not read: render.texture_filter says how "
                    "textures are filtered",
                    texture.sampler);
  }
  const int number = static_cast<int>(textures_.size());
  return {textures_.emplace(key, number).first->second, set, uv_transform(info.extensions)};
}

/* Clamps a factor to 0..1, with a warning. */
float MaterialBuilder::unit(double value, const std::string &what) {
  if (!(value >= 0.0 && value <= 1.0))
    warnings_.add("%s: %g is clamped to 0..1", what.c_str(), value);
  return static_cast<float>(std::min(std::max(value, 0.0), 1.0));
}

double emissive_strength(const tinygltf::Material &in, const std::string &name) {
  const auto it = in.extensions.find("KHR_materials_emissive_strength");
  if (it == in.extensions.end() || !it->second.Has("emissiveStrength"))
    return 1.0;
  const tinygltf::Value &value = it->second.Get("emissiveStrength");
  const double strength = value.GetNumberAsDouble();
  if (!value.IsNumber() || !(strength >= 0.0) || !std::isfinite(strength))
    fail(PL_E_FORMAT, "%s: emissiveStrength must be a number that is not negative", name.c_str());
  return strength;
}

void MaterialBuilder::build(const tinygltf::Material &in, const std::string &name, bool used,
                            pl_material *out) {
  const tinygltf::PbrMetallicRoughness &pbr = in.pbrMetallicRoughness;
  const double strength = emissive_strength(in, name);
  for (size_t c = 0; c < 4; c++)
    out->base_color[c] = unit(pbr.baseColorFactor[c], name + ": baseColorFactor");
  for (size_t c = 0; c < 3; c++)
    out->emissive[c] = static_cast<float>(
        strength * static_cast<double>(in.emissiveFactor.size() == 3
                                           ? unit(in.emissiveFactor[c], name + ": emissiveFactor")
                                           : 0.0f));
  out->metallic = unit(pbr.metallicFactor, name + ": metallicFactor");
  out->roughness = unit(pbr.roughnessFactor, name + ": roughnessFactor");
  out->normal_scale = static_cast<float>(in.normalTexture.scale);
  out->alpha_cutoff = static_cast<float>(in.alphaCutoff);
  out->alpha_mode = in.alphaMode == "MASK"    ? PL_ALPHA_MASK
                    : in.alphaMode == "BLEND" ? PL_ALPHA_BLEND
                                              : PL_ALPHA_OPAQUE;
  out->double_sided = in.doubleSided;
  /* An unlit surface would be bright at night, so its colour is treated as paint. */
  if (used && in.extensions.count("KHR_materials_unlit") != 0)
    warnings_.add(
        "%s: KHR_materials_unlit is not followed: the surface is lit, by its metallic and "
        "roughness factors",
        name.c_str());
  read_layers(in, name, model_->unit, out, warnings_);
  out->base_color_map = out->metallic_roughness_map = out->normal_map = out->emissive_map =
      NO_TEXTURE;
  if (!used)
    return;
  out->base_color_map = slot(pbr.baseColorTexture, true, name + ": baseColorTexture");
  out->metallic_roughness_map =
      slot(pbr.metallicRoughnessTexture, false, name + ": metallicRoughnessTexture");
  const pl_texture_slot normals = slot(in.normalTexture, false, name + ": normalTexture");
  /* otherwise the mesh has no texture coordinates, and a warning was given */
  if (model_->tangents != nullptr) {
    out->normal_map = normals;
    note_normals(name + ": normalTexture", &out->normal_map);
  }
  if (in.occlusionTexture.index >= 0)
    warnings_.add("occlusion maps are not read: what they approximate is traced");
  out->emissive_map = slot(in.emissiveTexture, true, name + ": emissiveTexture");
  for (const LayerMap &map : layer_maps(in)) {
    const bool bends = map.slot == &pl_material_layers::coat_normal_map;
    const pl_texture_slot found = slot(map.info, map.srgb, name + ": " + map.name);
    if (bends && model_->tangents == nullptr)
      continue;
    out->layers.*map.slot = found;
    if (bends) {
      out->layers.coat_normal_scale = static_cast<float>(map.info.scale);
      note_normals(name + ": " + map.name, &out->layers.coat_normal_map);
    }
  }
}

void MaterialBuilder::decode_textures() {
  if (textures_.empty())
    return;
  void *memory;
  check(pl_alloc_or_fail(textures_.size(), sizeof(pl_texture *), "textures", &memory));
  model_->textures = static_cast<pl_texture **>(memory);
  model_->texture_count = textures_.size();
  const uint64_t limit =
      std::min<uint64_t>(MAX_TEXELS, FREE_TEXELS + TEXELS_PER_BYTE * asset_.source->total_bytes());
  uint64_t texels = 0;
  for (const auto &entry : textures_) {
    const TextureKey &key = entry.first;
    const ImageRef &ref = asset_.images.at(static_cast<size_t>(key.image));
    const Bytes bytes = ref.view >= 0 ? view_bytes(asset_, ref.view, ref.name) : ref.file;
    pl_image image;
    check(pl_image_decode(bytes.data, bytes.size, ref.name.c_str(), &image));
    texels += static_cast<uint64_t>(image.width) * static_cast<uint64_t>(image.height);
    if (texels > limit) {
      pl_image_clear(&image);
      fail(PL_E_RANGE, "%s: the model's images have more than %llu texels", ref.name.c_str(),
           static_cast<unsigned long long>(limit));
    }
    if (!key.srgb)
      check_normals(entry.second, image);
    check(pl_texture_create(&image, key.srgb, key.wrap_u, key.wrap_v,
                            &model_->textures[entry.second]));
  }
}

} // namespace

Needs needs_of_material(const Asset &asset, int index) {
  Needs needs;
  if (index < 0)
    return needs;
  const tinygltf::Material &material = asset.model.materials.at(static_cast<size_t>(index));
  const auto note = [&](const auto &map) {
    const int set = uv_set_of(map.texCoord, map.extensions);
    if (map.index >= 0 && set <= 1)
      needs.uv_set[set] = true;
    return map.index >= 0 && set <= 1 ? set : -1;
  };
  note(material.pbrMetallicRoughness.baseColorTexture);
  note(material.pbrMetallicRoughness.metallicRoughnessTexture);
  note(material.emissiveTexture);
  /* One tangent frame serves all; the order of preference is base normal map, coat normal map,
   * anisotropy direction. */
  int set = note(material.normalTexture), coat = -1, turn = -1;
  for (const LayerMap &map : layer_maps(material)) {
    const int own = note(map.info);
    coat = map.slot == &pl_material_layers::coat_normal_map ? own : coat;
    turn = map.slot == &pl_material_layers::anisotropy_map ? own : turn;
  }
  set = set >= 0 ? set : coat >= 0 ? coat : turn;
  needs.tangents = set >= 0 || is_anisotropic(material);
  needs.tangent_uv_set = std::max(set, 0);
  return needs;
}

void build_materials(const Asset &asset, const std::vector<bool> &used, pl_model *model,
                     Warnings &warnings) {
  const size_t in_file = asset.model.materials.size();
  const size_t count = in_file + (used.back() ? 1 : 0);
  void *memory;
  check(pl_alloc_or_fail(count, sizeof(pl_material), "materials", &memory));
  model->materials = static_cast<pl_material *>(memory);
  model->material_count = count;
  MaterialBuilder builder(asset, model, warnings);
  for (size_t i = 0; i < count; i++) {
    const tinygltf::Material standard;
    const tinygltf::Material &in = i < in_file ? asset.model.materials[i] : standard;
    const std::string number = "material " + std::to_string(i);
    const std::string name = i == in_file ? "default" : in.name.empty() ? number : in.name;
    model->materials[i].name = pl_strdup(name.c_str());
    if (model->materials[i].name == nullptr)
      fail(PL_E_MEMORY, "out of memory for materials");
    builder.build(in, "materials[" + std::to_string(i) + "]", used[i], &model->materials[i]);
  }
  builder.decode_textures();
}

} // namespace pl_gltf
