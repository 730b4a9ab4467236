/* Movable parts of a file: the table of nodes and the animations. Internal to io. */
#ifndef PL_IO_GLTF_MOTION_HPP
#define PL_IO_GLTF_MOTION_HPP

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "geom/model.h"
#include "io/gltf_mesh.hpp"

namespace pl_gltf {

/* A node with the result of the scene traversal. */
struct Placed {
  bool in_scene = false;
  int parent = -1;
  Affine local; /* file axes */
};

/* Fills model->nodes. `order`: nodes of the scene, parents before children. */
void build_nodes(const Asset &asset, const std::vector<Placed> &placed,
                 const std::vector<int> &order, pl_model *model);

/* Fills model->animations from the file's `animations`. An invalid one is omitted with a warning:
 * the rest pose does not need it. */
void build_animations(const Asset &asset, const nlohmann::json &animations,
                      const std::vector<Placed> &placed, pl_model *model, Warnings &warnings);

} // namespace pl_gltf

#endif
