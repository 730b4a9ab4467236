/* Table of the kinds of nodes. */
#include "shade/node.h"

#include <string.h>

#include "shade/node_rows.h"

#define PL_ADDRESS(row) &pl_node_##row,
const pl_node_kind *const pl_node_kinds[] = {&pl_node_value,
                                             &pl_node_color,
                                             &pl_node_coordinates,
                                             &pl_node_mapping,
                                             &pl_node_math,
                                             &pl_node_vector_math,
                                             &pl_node_mix,
                                             &pl_node_ramp,
                                             &pl_node_noise,
                                             &pl_node_musgrave,
                                             &pl_node_voronoi,
                                             &pl_node_wave,
                                             &pl_node_white_noise,
                                             &pl_node_checker,
                                             &pl_node_brick,
                                             &pl_node_panel,
                                             &pl_node_bump,
                                             &pl_node_image,
                                             &pl_node_normal_map,
                                             &pl_node_fresnel,
                                             &pl_node_layer_weight,
                                             &pl_node_model_material,
                                             PL_REFLECTANCES(PL_ADDRESS)};
const size_t pl_node_kind_count = sizeof pl_node_kinds / sizeof pl_node_kinds[0];

const pl_node_kind *pl_node_kind_find(const char *name) {
  for (size_t i = 0; i < pl_node_kind_count; i++)
    if (strcmp(pl_node_kinds[i]->name, name) == 0)
      return pl_node_kinds[i];
  return NULL;
}
