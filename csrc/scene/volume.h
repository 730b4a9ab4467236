/* Bounded volumes: scattering, absorbing or emitting media inside a shape that moves with an
 * entity.
 */
#ifndef PL_SCENE_VOLUME_H
#define PL_SCENE_VOLUME_H

#include "base/status.h"
#include "geom/bound.h"
#include "math/rotation.h"
#include "shade/graph.h"

enum { PL_VOLUMES_MAX = 16 }; /* per frame */

/* A volume of a frame. Its medium is homogeneous, or scaled by the density of a graph. */
typedef struct pl_volume {
  const char *name; /* borrowed, for error messages */
  const pl_bound *bound;
  double size[3];      /* m, of the bound */
  size_t parent;       /* entity that it moves with: an object, or craft_count + body index */
  pl_pose local;       /* axes of the bound in the parent's axes, m */
  float extinction[3]; /* 1/m in each band */
  float albedo[3];     /* single-scattering albedo in each band, 0..1 */
  float g;             /* mean cosine of the scattering angle, -1..1 */
  float emission[3];   /* W m-3 sr-1 */
  /* step length along rays near the origin of the bound; steps grow with the distance from it. 0:
   * uniform steps */
  double core_m;
  const pl_graph *graph;      /* borrowed; NULL: homogeneous. See shade/graph_medium.h */
  const pl_value *parameters; /* of the graph, borrowed */
  float random;               /* 0..1, derived from the name */
} pl_volume;

/* Returns PL_E_RANGE, naming the volume, for values out of range. `entities`: number of possible
 * parents. */
pl_status pl_volumes_check(const pl_volume *volumes, size_t count, size_t entities);

/* Returns the largest value of the phase function, 1/sr: that of Henyey and Greenstein in its peak.
 */
double pl_volume_phase_max(const pl_volume *volume);

#endif
