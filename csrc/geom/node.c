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
