/* Rows of the table of nodes; each is defined in the file of its kind. Internal to shade. */
#ifndef PL_SHADE_NODE_ROWS_H
#define PL_SHADE_NODE_ROWS_H

#include "shade/node.h"

/* node_input.c */
extern const pl_node_kind pl_node_value, pl_node_color;
/* node_coordinates.c */
extern const pl_node_kind pl_node_coordinates, pl_node_mapping;
/* node_math.c; the last two are the compiler's conversions to a scalar */
extern const pl_node_kind pl_node_math, pl_node_mean, pl_node_luminance;
/* node_vector_math.c */
extern const pl_node_kind pl_node_vector_math;
/* node_mix.c */
extern const pl_node_kind pl_node_mix, pl_node_ramp;
/* node_noise.c, node_voronoi.c, node_wave.c */
extern const pl_node_kind pl_node_noise, pl_node_musgrave, pl_node_voronoi, pl_node_wave;
/* node_cells.c */
extern const pl_node_kind pl_node_white_noise, pl_node_checker;
/* node_panel.c */
extern const pl_node_kind pl_node_brick, pl_node_panel;
/* node_image.c */
extern const pl_node_kind pl_node_image;
/* node_own.c */
extern const pl_node_kind pl_node_model_material;
enum { PL_OWN_EMISSION = 3 }; /* index of its output `emission` */
/* node_normal_map.c */
extern const pl_node_kind pl_node_normal_map;
/* node_fresnel.c */
extern const pl_node_kind pl_node_fresnel, pl_node_layer_weight;
/* node_bump.c */
extern const pl_node_kind pl_node_bump;
/* node_surface.c: one for each reflectance model */
#define PL_NODE_OF_REFLECTANCE(row) extern const pl_node_kind pl_node_##row;
PL_REFLECTANCES(PL_NODE_OF_REFLECTANCE)
#undef PL_NODE_OF_REFLECTANCE

/* Inputs that every surface has, in this order, before those of its reflectance model. */
typedef enum pl_surface_socket {
  PL_SURFACE_BASE_COLOR,
  PL_SURFACE_NORMAL,
  PL_SURFACE_EMISSION_COLOR,
  PL_SURFACE_EMISSION_STRENGTH,
  PL_SURFACE_ALPHA, /* lazy: evaluated alone where a ray tests whether there is a surface */
  PL_SURFACE_SOCKETS
} pl_surface_socket;

#endif
