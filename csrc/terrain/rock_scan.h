/* Shapes of measured rocks: a closed mesh as the distance of its surface in all directions from its
 * centre, along its principal axes.
 *
 * Distances are in a table over an octahedral map of directions (Cigolle et al., "A survey of
 * efficient representations for independent unit vectors", JCGT 2014), about 1.4 degrees apart, and
 * bilinear between. Where a ray from the centre meets the surface more than once, the furthest
 * counts: overhangs are filled. */
#ifndef PL_TERRAIN_ROCK_SCAN_H
#define PL_TERRAIN_ROCK_SCAN_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "math/vec.h"

typedef struct pl_rock_scan {
  uint64_t serial; /* of this table; no other of the process has it */
  float *radii;    /* owned; the greatest is 1 */
  double folded;   /* fraction of directions in which overhangs were filled */
} pl_rock_scan;

/* The mesh of a rock, in any units and any axes. */
typedef struct pl_rock_model {
  const double (*positions)[3];
  size_t vertex_count;
  const uint32_t (*triangles)[3];
  size_t triangle_count;
} pl_rock_model;

/* PL_E_RANGE for vertices that are not there or not finite, and for a surface that does not
 * surround its centre, the mean of its area. */
pl_status pl_rock_scan_create(const pl_rock_model *model, pl_rock_scan *out);
void pl_rock_scan_clear(pl_rock_scan *scan);

/* Distance of the surface in a unit direction; z is along the shortest axis, x the longest. */
double pl_rock_scan_radius(const pl_rock_scan *scan, pl_vec3 direction);

#endif
