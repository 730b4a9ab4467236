/* The tree of bodies and objects. Each has a position relative to its parent and its own rotation.
 */
#ifndef PL_ORBIT_TREE_H
#define PL_ORBIT_TREE_H

#include <stddef.h>

#include "base/status.h"
#include "math/rotation.h"
#include "orbit/propagator.h"
#include "orbit/turn.h"

typedef enum pl_path_kind { PL_PATH_FIXED, PL_PATH_PROPAGATED, PL_PATH_GIVEN } pl_path_kind;

/* Path of a node relative to its parent's centre, or of a root in the root frame; ICRF axes. */
typedef struct pl_path {
  pl_path_kind kind;
  pl_vec3 position_m;              /* fixed */
  const pl_propagator *propagator; /* propagated; borrowed, must outlive the tree */
  size_t slot;                     /* given: index among the caller's states */
} pl_path;

typedef struct pl_tree_node {
  const char *name; /* for errors; borrowed, must outlive the tree */
  ptrdiff_t parent; /* index of the parent in the same array, -1 for a root */
  pl_path path;
  pl_turn turn;
} pl_tree_node;

/* States and rotations that the caller provides at the requested times, ordered by time, then by
 * slot. */
typedef struct pl_tree_given {
  size_t state_slots;
  const pl_state *states; /* [time * state_slots + slot] */
  size_t quat_slots;
  const pl_quat *quats; /* [time * quat_slots + slot]; need not be unit */
} pl_tree_given;

/* Results, in memory of the caller. */
typedef struct pl_tree_states {
  pl_pose *poses;      /* [time * nodes + node], to the root frame (ICRF axes) */
  pl_vec3 *velocities; /* [time * nodes + node], m/s in the root frame */
  pl_state *relative;  /* [node * times + time], to the centre of the parent, ICRF axes */
} pl_tree_states;

/* A tree that is ready for evaluation. */
typedef struct pl_tree pl_tree;

/* Creates a tree. Copies `nodes`, which may be in any order. Times count from the epoch JD(TDB) =
 * tdb_day + tdb_fraction. Errors name the node: PL_E_ARGUMENT for a parent or target that does not
 * exist, a cycle of parents (the message lists the names), or a root that orbits or uses a parent's
 * frame; PL_E_RANGE for numbers that are not finite or a zero axis. Destroy with pl_tree_destroy.
 */
pl_status pl_tree_create(size_t count, const pl_tree_node *nodes, double tdb_day,
                         double tdb_fraction, pl_tree **out);
void pl_tree_destroy(pl_tree *tree);

/* Computes the states at `times` times, in seconds after the epoch. `given` may be NULL if no node
 * uses it. All positions are computed before all rotations, so that any node may point at any
 * other. Does not allocate memory (a propagator may, at first use). Thread-safe on one tree. Fails
 * with PL_E_RANGE and names the node for times and given values that are not finite, and if a path
 * or a rotation is undefined. */
pl_status pl_tree_evaluate(const pl_tree *tree, size_t times, const double *t_s,
                           const pl_tree_given *given, const pl_tree_states *out);

#endif
