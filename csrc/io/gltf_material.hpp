/* From glTF materials to the model's materials and textures. Internal to io. */
#ifndef PL_IO_GLTF_MATERIAL_HPP
#define PL_IO_GLTF_MATERIAL_HPP

#include <vector>

#include "geom/model.h"
#include "io/gltf_access.hpp"
#include "io/gltf_mesh.hpp"

namespace pl_gltf {

/* What the mesh must provide for material `index` (-1: the default material). */
Needs needs_of_material(const Asset &asset, int index);

/* Fills model->materials and ->textures. `used[i]`: some triangle has material i; the last entry is
 * the default material, present only when used. Maps of unused materials are not decoded, maps for
 * which the model has no texture coordinates are left out with a warning. */
void build_materials(const Asset &asset, const std::vector<bool> &used, pl_model *model,
                     Warnings &warnings);

/* Reads what KHR_materials_clearcoat, _transmission, _ior, _specular and _anisotropy give into
 * out->layers, but for their maps; numbers that are none or out of range are errors. `unit`: of the
 * mesh. */
void read_layers(const tinygltf::Material &in, const std::string &name, double unit,
                 pl_material *out, Warnings &warnings);

/* A map that one of these extensions gives. */
struct LayerMap {
  std::string name; /* EXTENSION.key */
  bool srgb;
  pl_texture_slot pl_material_layers::*slot;
  tinygltf::NormalTextureInfo info; /* its scale: of a normal map */
};
/* The maps whose factors do not switch them off. */
std::vector<LayerMap> layer_maps(const tinygltf::Material &in);
/* Whether the highlights of the material have a direction. */
bool is_anisotropic(const tinygltf::Material &in);

} // namespace pl_gltf

#endif
