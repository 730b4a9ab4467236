/* Composes the transforms of nodes. */
#include "geom/node.h"

#include "base/memory.h"

void pl_nodes_clear(pl_nodes *nodes) {
  for (size_t i = 0; nodes->items != NULL && i < nodes->count; i++)
    pl_free(nodes->items[i].name);
  pl_free(nodes->items);
  pl_free(nodes->order);
  *nodes = (pl_nodes){0};
}

pl_affine pl_trs_affine(const pl_trs *trs) {
  pl_affine out = {pl_mat3_from_quat(trs->q), trs->t};
  for (int i = 0; i < 3; i++) {
    const pl_vec3 row = out.m.row[i];
    out.m.row[i] = (pl_vec3){row.x * trs->s.x, row.y * trs->s.y, row.z * trs->s.z};
  }
  return out;
}

pl_affine pl_nodes_base(const pl_nodes *nodes) {
  pl_affine out = PL_AFFINE_IDENTITY;
  if (nodes->stretched) {
    out.m.row[0].x = nodes->stretch.x;
    out.m.row[1].y = nodes->stretch.y;
    out.m.row[2].z = nodes->stretch.z;
  }
  return out;
}

void pl_nodes_globals(const pl_nodes *nodes, const pl_affine *locals, pl_affine *globals) {
  const pl_affine base = pl_nodes_base(nodes);
  for (size_t i = 0; i < nodes->count; i++)
    globals[i] = PL_AFFINE_IDENTITY;
  for (size_t k = 0; k < nodes->order_count; k++) {
    const int i = nodes->order[k], parent = nodes->items[i].parent;
    const pl_affine *local = locals != NULL ? &locals[i] : &nodes->items[i].local;
    globals[i] = pl_affine_compose(parent >= 0 ? &globals[parent] : &base, local);
  }
}
