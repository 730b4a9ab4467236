/* Shared by the nodes of procedural patterns: inputs and the point of evaluation. Internal to
 * shade. */
#ifndef PL_SHADE_NODE_PATTERN_H
#define PL_SHADE_NODE_PATTERN_H

#include "shade/node.h"

/* Input 0 of every pattern is a vector, input 1 its scale. */
#define PL_PATTERN_VECTOR                                                                          \
  {"vector", PL_VECTOR, {0.0f, 0.0f, 0.0f}, "Coordinates, of a coordinates or mapping node"}, {    \
    "scale", PL_SCALAR, {1.0f, 1.0f, 1.0f}, "Cells per unit of the coordinates"                    \
  }
#define PL_PATTERN_SEED                                                                            \
  { "seed", PL_NUMBER, 0, 0, 4294967295.0, NULL, 0, "Chooses the pattern" }

/* In cells; smaller rounding errors are not visible. */
#define PL_PATTERN_GRAIN 1e-3f

typedef struct pl_pattern_place {
  pl_vec3 point; /* in cells */
  float width;   /* diameter of the footprint, in cells */
  float side;    /* side of the square with the footprint's area, in cells */
} pl_pattern_place;

static inline pl_pattern_place pl_pattern_place_of(const pl_node_call *call) {
  const float *v = call->in[0], size = fabsf(call->in[1][0]);
  /* A scale of zero gives one point, for any footprint. */
  float radius = size > 0.0f ? size * v[3] : 0.0f;
  /* Large coordinates in float cannot resolve cells: the rounding error is added to the footprint,
   * otherwise neighbouring points would form random blocks. */
  const float grain = 0x1p-23f * size * pl_maxf(fabsf(v[0]), pl_maxf(fabsf(v[1]), fabsf(v[2])));
  if (grain > PL_PATTERN_GRAIN)
    radius = pl_maxf(radius, 0.5f * grain);
  const double s = (double)call->in[1][0];
  return (pl_pattern_place){{s * (double)v[0], s * (double)v[1], s * (double)v[2]},
                            2.0f * radius,
                            sqrtf(PL_PI_F) * radius};
}

static inline uint32_t pl_pattern_seed(const pl_node_call *call, size_t constant) {
  return (uint32_t)(int64_t)call->constants[constant].number;
}

#endif
