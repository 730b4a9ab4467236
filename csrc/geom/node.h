/* Nodes of a model: the hierarchy that places its meshes, by which its parts can move.
 *
 * Axes are the model's (z-up): a vector (x, y, z) in the axes of a node of the file is (x, -z, y)
 * here. Lengths are model units (geom/model.h), not mesh units. */
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
  pl_affine local; /* node to parent, at rest */
  pl_trs trs;      /* components of `local`; not used when the file gives a matrix */
  bool has_matrix;
} pl_node;

/* All nodes of a file by their index in the file; nodes outside its scene are not in `order`. */
typedef struct pl_nodes {
  /* the model is scaled along its axes: root nodes are below a node of scale `stretch` */
  bool stretched;
  pl_vec3 stretch; /* used when `stretched` is set */
  pl_node *items;  /* owned */
  size_t count;
  int *order; /* owned: nodes of the scene, parents before children */
  size_t order_count;
} pl_nodes;

void pl_nodes_clear(pl_nodes *nodes);
pl_affine pl_trs_affine(const pl_trs *trs);
/* Returns the transform of the root nodes: the identity, or the scale `stretch`. */
pl_affine pl_nodes_base(const pl_nodes *nodes);

#ifdef __cplusplus
}
#endif
#endif
