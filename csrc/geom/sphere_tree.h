/* Trees of bounding spheres over items that are spheres themselves: instances of a tracer, objects
 * and bodies of a snapshot. */
#ifndef PL_GEOM_SPHERE_TREE_H
#define PL_GEOM_SPHERE_TREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/memory.h"
#include "base/status.h"
#include "math/vec.h"

#define PL_INNER_NODE UINT32_MAX
#define PL_NO_ITEM UINT32_MAX /* from searches of the tree, after the last */

/* Sphere of one item, or a sphere about those of all items from the next node up to `after`. */
typedef struct pl_sphere {
  pl_vec3 center;
  double radius_m;
  uint32_t after; /* index of the first sphere behind its subtree */
  uint32_t item;  /* index of the item; PL_INNER_NODE for an inner node */
} pl_sphere;

/* In depth-first order: each sphere is followed by its subtree. A few items are in a row, without
 * inner nodes, in their order. */
typedef struct pl_sphere_tree {
  const pl_sphere *nodes;
  size_t count;
} pl_sphere_tree;

/* Builds the tree of the centres and radii of some leaves, whose items are their indices, in
 * `arena`. Sorts the leaves. */
pl_status pl_sphere_tree_build(pl_arena *arena, pl_sphere *leaves, size_t count,
                               pl_sphere_tree *out);

/* Returns the node to visit next, by whether sphere k was entered. */
static inline size_t pl_sphere_next(const pl_sphere_tree *tree, size_t k, bool entered) {
  return entered ? k + 1 : tree->nodes[k].after;
}

#endif
