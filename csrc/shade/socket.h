/* What flows into and out of nodes of material graphs, and into reflectance models. */
#ifndef PL_SHADE_SOCKET_H
#define PL_SHADE_SOCKET_H

#include "math/vec.h"

/* A value on a link: x, y, z, and where it is a position the radius of the footprint about it, in
 * its own units: a pattern smaller than that counts as its mean. An infinite radius is the mean of
 * everything. A scalar stands in x, y and z alike, so that it may be used as a vector. */
typedef float pl_value[4];

/* A scalar input takes a vector's mean, or a colour's luminance (Rec. 709). */
typedef enum pl_socket_type { PL_SCALAR, PL_VECTOR, PL_COLOR } pl_socket_type;

typedef struct pl_socket {
  const char *name;
  pl_socket_type type;
  float fallback[3]; /* of an input that nothing is given for */
  const char *doc;   /* unit and range */
} pl_socket;

enum { PL_NODE_SOCKETS = 24 };

#define PL_ROWS(array) (array), sizeof(array) / sizeof((array)[0])

/* x within 0..high; 0 of what is not a number. */
static inline float pl_clipped(float x, float high) { return x > 0.0f ? pl_minf(x, high) : 0.0f; }

#endif
