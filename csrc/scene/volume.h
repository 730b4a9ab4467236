/* Bounded volumes: dust, gas or light within a shape that moves with a thing. */
#ifndef PL_SCENE_VOLUME_H
#define PL_SCENE_VOLUME_H

#include "base/status.h"
#include "geom/bound.h"
#include "math/rotation.h"
#include "shade/graph.h"

enum { PL_VOLUMES_MAX = 16 }; /* in a frame */

/* A frame's volume. What it is made of is the same everywhere, times a graph's density. */
typedef struct pl_volume {
  const char *name; /* borrowed, for errors */
  const pl_bound *bound;
  double size[3]; /* m, the bound's */
  size_t parent;  /* the thing that it moves with: an object, or a body after the craft_count */
  pl_pose local;  /* axes of the bound in those of the parent, m */
  float extinction[3];   /* 1/m in each band */
  float albedo[3];       /* part of it that is scattered, 0..1 */
  float g;               /* mean cosine of the angle of scattering, -1..1 */
  float emission[3];     /* W m-3 sr-1 */
  double core_m;         /* steps along rays are this short near the origin of the bound, and longer
                            farther off; 0: all alike */
  const pl_graph *graph; /* borrowed; NULL: as dense everywhere. See shade/graph_medium.h */
  const pl_value *parameters; /* of the graph, borrowed */
  float random;               /* 0..1, of the name */
} pl_volume;

/* PL_E_RANGE naming the volume for values out of range. things: so many may be parents. */
pl_status pl_volumes_check(const pl_volume *volumes, size_t count, size_t things);

/* Largest value of the phase function, 1/sr: Henyey and Greenstein's, forwards. */
double pl_volume_phase_max(const pl_volume *volume);

#endif
