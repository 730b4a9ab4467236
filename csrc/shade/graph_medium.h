/* Graphs as media: what a surface's inputs mean where there is no surface. */
#ifndef PL_SHADE_GRAPH_MEDIUM_H
#define PL_SHADE_GRAPH_MEDIUM_H

#include "shade/graph.h"

/* A medium's alpha is its density, its base colour the part of the light that is scattered rather
 * than absorbed, and its emission that of a metre of it. */
typedef struct pl_medium {
  float density;     /* 0..1 */
  pl_vec3f albedo;   /* 0..1; the surface's default where the graph gives none */
  pl_vec3f emission; /* W m-3 sr-1, where the density is 1 */
} pl_medium;

/* What is not a number is 0. Thread-safe. */
pl_medium pl_graph_medium(const pl_graph *graph, const pl_graph_point *point,
                          const pl_value *params);
/* Its density alone. */
float pl_graph_density(const pl_graph *graph, const pl_graph_point *point, const pl_value *params);
/* Upper bound of its emission. */
double pl_graph_medium_emission_max(const pl_graph *graph);

#endif
