/* Nodes of a model: the hierarchy that places its meshes, kept so that parts of it can move.
 *
 * Axes are the model's (z-up): a node's own axis (x, y, z) of the file is (x, -z, y) here. Lengths
 * are model units (geom/model.h), not those of the mesh. */
#ifndef PL_GEOM_NODE_H
#define PL_GEOM_NODE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"
#include "math/affine.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Scale, then rotation, then translation (glTF 2.0, 3.5.3). */
typedef struct pl_trs {
  pl_vec3 t;
  pl_quat q; /* unit */
  pl_vec3 s;
} pl_trs;

typedef struct pl_node {
  char *name;      /* owned, never NULL; "node N" when the file gives none */
  int parent;      /* index, or -1 */
  pl_affine local; /* to the parent, at rest */
  pl_trs trs;      /* of `local`; not used when the file gives a matrix */
  bool has_matrix;
} pl_node;

/* All nodes of a file by the file's indices; nodes outside its scene are in no order. */
typedef struct pl_nodes {
  bool stretched;  /* the model is, along its axes: root nodes are below a node of this scale */
  pl_vec3 stretch; /* counts where `stretched` is set */
  pl_node *items;  /* owned */
  size_t count;
  int *order; /* owned: the scene's nodes, parents before children */
  size_t order_count;
} pl_nodes;

void pl_nodes_clear(pl_nodes *nodes);
pl_affine pl_trs_affine(const pl_trs *trs);
/* What root nodes are placed by: the identity, or the stretch. */
pl_affine pl_nodes_base(const pl_nodes *nodes);
/* Node to root, of the scene's nodes; others become the identity. `locals`: one a node, or NULL for
 * the rest pose. */
void pl_nodes_globals(const pl_nodes *nodes, const pl_affine *locals, pl_affine *globals);

#ifdef __cplusplus
}
#endif
#endif
