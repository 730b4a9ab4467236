/* Surfaces: what a graph ends in. Their inputs become fields of pl_surface (graph.c). */
#include "shade/node_rows.h"

/* Shared by all, in the order of pl_surface_socket. */
static const pl_socket inputs[] = {
    {"base_color", PL_COLOR, {0.8f, 0.8f, 0.8f}, "Linear RGB, cut off at 0 and 1"},
    {"normal", PL_VECTOR, {0.0f, 0.0f, 0.0f}, "Of a bump or normal map; the mesh's where zero"},
    {"emission_color", PL_COLOR, {1.0f, 1.0f, 1.0f}, "Factor on the strength"},
    {"emission_strength", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "Radiance, W m-2 sr-1 in each band"},
    {"metallic", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "0..1"},
    {"roughness", PL_SCALAR, {0.5f, 0.5f, 0.5f}, "0..1; GGX alpha is its square"},
};

const pl_node_kind pl_node_principled = {
    .name = "principled",
    .doc = "A surface: metal or coated diffuse, as glTF's metallic-roughness model",
    .inputs = inputs,
    .input_count = 6,
    .reads_point = true,
    .reflectance = &pl_reflectance_metallic_roughness,
};

const pl_node_kind pl_node_lambert = {
    .name = "lambert",
    .doc = "A surface: as bright from everywhere",
    .inputs = inputs,
    .input_count = 4,
    .reads_point = true,
    .reflectance = &pl_reflectance_lambert,
};
