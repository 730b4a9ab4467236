/* Collects the extents of visible objects and writes object labels. */
#include "annotate/object_label.h"

void pl_extent_add(pl_extent *extents, const pl_vertex *points, size_t stride, const int tile[4]) {
  for (int y = 0; y < tile[3]; y++) {
    for (int x = 0; x < tile[2]; x++) {
      const pl_surface_id id = points[(size_t)y * stride + (size_t)x].surface_id;
      if (pl_surface_kind_of(id) != PL_SURFACE_MESH)
        continue;
      const pl_extent pixel = {tile[0] + x, tile[1] + y, tile[0] + x, tile[1] + y, 1};
      pl_extent_merge(&extents[pl_surface_index(id)], &pixel);
    }
  }
}

void pl_extent_merge(pl_extent *into, const pl_extent *from) {
  into->x0 = into->x0 < from->x0 ? into->x0 : from->x0;
  into->y0 = into->y0 < from->y0 ? into->y0 : from->y0;
  into->x1 = into->x1 > from->x1 ? into->x1 : from->x1;
  into->y1 = into->y1 > from->y1 ? into->y1 : from->y1;
  into->count += from->count;
}

void pl_object_label_fill(const pl_snapshot *shot, const pl_shot_object *object,
                          const pl_extent *extent, pl_object_label *out) {
  const pl_mat3 r = pl_mat3_mul(pl_mat3_transpose(shot->camera_to_root), object->rotation);
  const pl_vec3 t = pl_mat3_mul_vec_t(shot->camera_to_root, object->position);
  *out = (pl_object_label){
      .R_m2c = {r.row[0].x, r.row[0].y, r.row[0].z, r.row[1].x, r.row[1].y, r.row[1].z, r.row[2].x,
                r.row[2].y, r.row[2].z},
      .t_m2c = {t.x, t.y, t.z},
      .visib_fract = NAN,
      .instance_id = object->object->instance_id,
      .obj_id = object->object->obj_id,
      .bbox_visib = {-1, -1, -1, -1},
      .bbox_obj = {-1, -1, -1, -1},
      .px_count_visib = extent->count,
      .px_count_all = -1,
      .px_count_valid = -1,
      .in_view = object->in_frame,
  };
  if (extent->count > 0) {
    out->bbox_visib[0] = extent->x0;
    out->bbox_visib[1] = extent->y0;
    out->bbox_visib[2] = extent->x1 - extent->x0;
    out->bbox_visib[3] = extent->y1 - extent->y0;
  }
}
