/* Transforms of all nodes by composition from the root, to judge articulation and readers. */
#ifndef PL_TESTS_NODE_GLOBALS_H
#define PL_TESTS_NODE_GLOBALS_H

#include "geom/node.h"

/* Computes the node-to-root transforms of the scene's nodes; others become the identity. `locals`:
 * one per node, or NULL for the rest pose. */
static inline void node_globals(const pl_nodes *nodes, const pl_affine *locals,
                                pl_affine *globals) {
  const pl_affine base = pl_nodes_base(nodes);
  for (size_t i = 0; i < nodes->count; i++)
    globals[i] = PL_AFFINE_IDENTITY;
  for (size_t k = 0; k < nodes->order_count; k++) {
    const int i = nodes->order[k], parent = nodes->items[i].parent;
    const pl_affine *local = locals != NULL ? &locals[i] : &nodes->items[i].local;
    globals[i] = pl_affine_compose(parent >= 0 ? &globals[parent] : &base, local);
  }
}

#endif
