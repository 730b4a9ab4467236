/* Shared by the nodes of procedural patterns: inputs and the points of evaluation. Internal to
 * shade. */
#ifndef PL_SHADE_NODE_PATTERN_H
#define PL_SHADE_NODE_PATTERN_H

#include "math/lattice.h"
#include "shade/node.h"

/* Input 0 of every pattern is a vector, input 1 its scale. */
#define PL_PATTERN_VECTOR                                                                          \
  {"vector", PL_VECTOR, {0.0f, 0.0f, 0.0f}, "Coordinates, of a coordinates or mapping node"}, {    \
    "scale", PL_SCALAR, {1.0f, 1.0f, 1.0f}, "Cells per unit of the coordinates"                    \
  }
#define PL_PATTERN_SEED                                                                            \
  { "seed", PL_NUMBER, 0, 0, 4294967295.0, NULL, 0, "Chooses the pattern" }

/* Of all lanes: in cells; width: diameter of the footprint; side: of the square with its area. */
typedef struct pl_pattern_place {
  pl_point_lanes point;
  float width[PL_LANES], side[PL_LANES];
} pl_pattern_place;

void pl_pattern_place_of(const pl_node_call *call, pl_pattern_place *out);

/* Slopes of output 0 of a pattern, from its gradient per cell. */
void pl_pattern_slopes(const pl_node_call *call, const float gradient[3][PL_LANES]);

static inline pl_vec3 pl_pattern_point(const pl_pattern_place *place, size_t lane) {
  const double(*at)[PL_LANES] = place->point.at;
  return pl_vec3_make(at[0][lane], at[1][lane], at[2][lane]);
}

static inline uint32_t pl_pattern_seed(const pl_node_call *call, size_t constant) {
  return (uint32_t)(int64_t)call->constants[constant].number;
}

#endif
