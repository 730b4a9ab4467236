/* The tree of bodies and objects: each moves about its parent and turns on its own. */
#ifndef PL_ORBIT_TREE_H
#define PL_ORBIT_TREE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"
#include "math/rotation.h"
#include "orbit/body.h"
#include "orbit/kepler.h"

typedef enum pl_motion_kind { PL_MOTION_FIXED, PL_MOTION_KEPLER } pl_motion_kind;

/* Path of a node relative to its parent's centre. */
typedef struct pl_motion {
  pl_motion_kind kind;
  pl_vec3 position_m;     /* fixed: ICRF axes */
  pl_orbit orbit;         /* kepler */
  const pl_body *equator; /* kepler: the orbit is given on this body's equator of the epoch, x along
                             its ascending node on ICRF's; NULL: on ICRF */
} pl_motion;

typedef enum pl_turn_kind { PL_TURN_FIXED, PL_TURN_SPIN, PL_TURN_BODY, PL_TURN_LVLH } pl_turn_kind;

/* Rotation of a node, to ICRF whatever its parent does. */
typedef struct pl_turn {
  pl_turn_kind kind;
  pl_quat q;           /* fixed, and spin at t = 0; need not be unit */
  pl_vec3 axis;        /* spin: in the node's own frame; need not be unit */
  double rate_rad_s;   /* spin */
  const pl_body *body; /* body */
} pl_turn;

typedef struct pl_node {
  const char *name; /* for errors; borrowed, must outlive the tree */
  ptrdiff_t parent; /* index of the parent in the same array, -1 for a root */
  pl_motion motion; /* of a root: fixed, its place in the root frame */
  pl_turn turn;
} pl_node;

/* A tree ready to be evaluated. */
typedef struct pl_tree pl_tree;

/* Copies `nodes`, which may be in any order. Errors: PL_E_ARGUMENT for a parent that does not
 * exist, a cycle of parents (the text prints it by names), a root that orbits or faces a parent;
 * PL_E_RANGE for numbers that are not finite or a zero axis. Destroy with pl_tree_destroy. */
pl_status pl_tree_create(size_t count, const pl_node *nodes, pl_tree **out);
void pl_tree_destroy(pl_tree *tree);

/* Poses of all nodes in the root frame (ICRF axes) at the epoch JD(TDB) = tdb_day + tdb_fraction
 * plus each of `t_s`: out[time * nodes + node]. Thread-safe on one tree. */
pl_status pl_tree_poses(const pl_tree *tree, double tdb_day, double tdb_fraction, size_t time_count,
                        const double *t_s, pl_pose *out);

#endif
