/* Sockets: values that flow into and out of nodes of material graphs, and into reflectance models.
 */
#ifndef PL_SHADE_SOCKET_H
#define PL_SHADE_SOCKET_H

#include "base/wide.h"
#include "math/vec.h"

/* Value on a link: x, y, z, and for positions the radius of the footprint, in the units of the
 * position: patterns smaller than that are replaced by their mean. An infinite radius is the mean
 * over everything. A scalar is stored in x, y and z alike, so that it may be used as a vector. */
typedef float pl_value[4];
/* A value at each point of a batch: first the index of the number, then the lane. */
typedef float pl_lanes[4][PL_LANES];
/* Derivatives of a value at each point along the two axes of a tangent plane: first the axis, then
 * x, y or z, then the lane. */
typedef float pl_slopes[2][3][PL_LANES];

/* A scalar input converts a vector to its mean, and a colour to its luminance (Rec. 709). */
typedef enum pl_socket_type { PL_SCALAR, PL_VECTOR, PL_COLOR } pl_socket_type;

typedef struct pl_socket {
  const char *name;
  pl_socket_type type;
  float fallback[3]; /* value of an input that is not set */
  const char *doc;   /* unit and range */
} pl_socket;

enum { PL_NODE_SOCKETS = 24 };

/* x clamped to 0..high; 0 if x is not a number. */
static inline float pl_clipped(float x, float high) { return x > 0.0f ? pl_minf(x, high) : 0.0f; }

#endif
