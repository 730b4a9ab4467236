/* Surface nodes: the final node of a graph. Their inputs become fields of pl_surface (graph.c, and
 * `set` of the reflectance models). */
#include "shade/node_rows.h"

/* Inputs of all surfaces, in the order of pl_surface_socket. */
static const pl_socket inputs[PL_SURFACE_SOCKETS] = {
    {"base_color", PL_COLOR, {0.8f, 0.8f, 0.8f}, "Linear RGB, cut off at 0 and 1"},
    {"normal", PL_VECTOR, {0.0f, 0.0f, 0.0f}, "Of a bump or normal map; the mesh's where zero"},
    {"emission_color", PL_COLOR, {1.0f, 1.0f, 1.0f}, "Factor on the strength"},
    {"emission_strength", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "Radiance, W m-2 sr-1 in each band"},
    {"alpha",
     PL_SCALAR,
     {1.0f, 1.0f, 1.0f},
     "Opacity: below 0.5 there is no surface, nor where the model's material is not; not on "
     "bodies"},
};

#define PL_SURFACE(row)                                                                            \
  const pl_node_kind pl_node_##row = {                                                             \
      .name = #row,                                                                                \
      .inputs = inputs,                                                                            \
      .input_count = PL_SURFACE_SOCKETS,                                                           \
      .reads_point = true,                                                                         \
      .lazy = 1u << PL_SURFACE_ALPHA,                                                              \
      .reflectance = &pl_reflectance_##row,                                                        \
  };
PL_REFLECTANCES(PL_SURFACE)
