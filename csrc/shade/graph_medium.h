/* Graphs of participating media: meaning of the surface's inputs where there is no surface. */
#ifndef PL_SHADE_GRAPH_MEDIUM_H
#define PL_SHADE_GRAPH_MEDIUM_H

#include "shade/graph.h"

/* The density is the surface's alpha, the single-scattering albedo its base colour, and the
 * emission that of one metre of the medium. */
typedef struct pl_medium {
  float density;     /* 0..1 */
  pl_vec3f albedo;   /* 0..1; the surface's default if the graph does not set it */
  pl_vec3f emission; /* W m-3 sr-1, at density 1 */
} pl_medium;

/* Properties at a point; NaN becomes 0. Thread-safe. */
pl_medium pl_graph_medium(const pl_graph *graph, const pl_graph_point *point,
                          const pl_value *params);
/* The density alone. */
float pl_graph_density(const pl_graph *graph, const pl_graph_point *point, const pl_value *params);
/* Upper bound of the emission, W m-3 sr-1. */
double pl_graph_medium_emission_max(const pl_graph *graph);

#endif
