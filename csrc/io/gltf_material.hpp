/* Converts glTF materials to the model's materials and textures. Internal to io. */
#ifndef PL_IO_GLTF_MATERIAL_HPP
#define PL_IO_GLTF_MATERIAL_HPP

#include <vector>

#include "geom/model.h"
#include "io/gltf_access.hpp"
#include "io/gltf_mesh.hpp"

namespace pl_gltf {

/* Returns what the mesh must provide for material `index` (-1: the default material). */
Needs needs_of_material(const Asset &asset, int index);

/* Fills model->materials and ->textures. `used[i]`: some triangle has material i; the last entry is
 * the default material, which is created only when used. Maps of unused materials are not decoded;
 * maps for which the model has no texture coordinates are omitted with a warning. */
void build_materials(const Asset &asset, const std::vector<bool> &used, pl_model *model,
                     Warnings &warnings);

/* Reads KHR_materials_clearcoat, _transmission, _ior, _specular and _anisotropy into out->layers,
 * except for their maps. Values that are not numbers or out of range are errors. `unit`: that of
 * the mesh. */
void read_layers(const tinygltf::Material &in, const std::string &name, double unit,
                 pl_material *out, Warnings &warnings);

/* A map of one of these extensions. */
struct LayerMap {
  std::string name; /* EXTENSION.key */
  bool srgb;
  pl_texture_slot pl_material_layers::*slot;
  tinygltf::NormalTextureInfo info; /* its scale is used for normal maps only */
};
/* Returns the maps that are not disabled by a factor of 0. */
std::vector<LayerMap> layer_maps(const tinygltf::Material &in);
/* Returns true if the material has anisotropic highlights. */
bool is_anisotropic(const tinygltf::Material &in);

} // namespace pl_gltf

#endif
