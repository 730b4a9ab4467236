/* Bounds of the light that other entities throw onto a body, point by point. Mirrors light small
 * parts of it at most: the rest need not be sampled. */
#ifndef PL_SCENE_SENDERS_H
#define PL_SCENE_SENDERS_H

#include "base/memory.h"
#include "base/status.h"
#include "math/vec.h"
#include "plan/view.h"

typedef struct pl_sender {
  pl_vec3 center;   /* camera-relative, root axes, m */
  double radius_m;  /* of its bounding sphere */
  double intensity; /* radiance of a bounding disc that sends as much, times its radius squared */
} pl_sender;

/* Meshes that light a body. Radiances are W m-2 sr-1. */
typedef struct pl_senders {
  pl_sender *items;
  size_t count;
  double rest;   /* upper bound of what the body reflects of all other light, anywhere on it */
  double albedo; /* of the body, at most 1 */
  double least;  /* reflected light of others that is below this does not matter */
} pl_senders;

/* For entities[body], on which the light of the first `meshes` entities may matter. Sets `out` to
 * NULL where points are not worth telling apart: others' light matters anyway, entities are many,
 * or every change matters. Allocated in `arena`. */
pl_status pl_senders_make(const pl_view *view, size_t meshes, size_t body, double tolerance_dn,
                          pl_arena *arena, pl_senders **out);

/* A point of the body. */
typedef struct pl_senders_point {
  pl_vec3 position; /* camera-relative, root axes, m */
  pl_vec3f normal;  /* unit */
  pl_vec3f viewer;  /* direction to the viewer: unit */
  double alpha;     /* of waves: sqrt of twice the mean square slope along one axis; 0 for none */
} pl_senders_point;

/* Returns whether what a point of the body reflects of others' light may matter. */
bool pl_senders_light(const pl_senders *senders, const pl_senders_point *point);

#endif
