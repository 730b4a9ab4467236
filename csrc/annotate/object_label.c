/* Collects the extents of visible objects and writes object labels. */
#include "annotate/object_label.h"

/* Returns the slot of a surface; SIZE_MAX if it has no label. */
static size_t slot_of(pl_surface_id id, size_t first_body) {
  if (pl_surface_kind_of(id) == PL_SURFACE_MESH)
    return pl_surface_index(id);
  if (first_body == PL_EXTENT_NO_BODIES || pl_surface_is_none(id))
    return SIZE_MAX;
  return (pl_surface_is_mesh(id) ? 0 : first_body) + pl_surface_index(id);
}

void pl_extent_add(pl_extent *extents, size_t first_body, const pl_point *points, size_t stride,
                   const int tile[4]) {
  for (int y = 0; y < tile[3]; y++) {
    for (int x = 0; x < tile[2]; x++) {
      const size_t slot = slot_of(points[(size_t)y * stride + (size_t)x].surface_id, first_body);
      if (slot == SIZE_MAX)
        continue;
      const pl_extent pixel = {tile[0] + x, tile[1] + y, tile[0] + x, tile[1] + y, 1};
      pl_extent_merge(&extents[slot], &pixel);
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

/* Where an entity is, and its ids. */
typedef struct entity {
  pl_mat3 rotation; /* own axes to root axes */
  pl_vec3 position; /* camera-relative, m */
  int32_t instance_id, obj_id;
  bool in_view;
} entity;

static entity entity_at(const pl_snapshot *shot, size_t slot) {
  const pl_shot_object *object = slot < shot->object_count ? &shot->objects[slot] : NULL;
  if (slot < shot->craft_count)
    return (entity){object->rotation, object->position, object->object->instance_id,
                    object->object->obj_id, object->in_frame};
  const pl_shot_body *body =
      &shot->bodies[object != NULL ? (size_t)object->object->body : slot - shot->object_count];
  return (entity){body->rotation, body->center, body->body->instance_id, body->body->obj_id,
                  object != NULL ? object->in_frame : body->in_frame};
}

void pl_object_label_fill(const pl_snapshot *shot, size_t slot, const pl_extent *extent,
                          pl_object_label *out) {
  const entity entity = entity_at(shot, slot);
  const pl_mat3 r = pl_mat3_mul(pl_mat3_transpose(shot->camera_to_root), entity.rotation);
  const pl_vec3 t = pl_mat3_mul_vec_t(shot->camera_to_root, entity.position);
  *out = (pl_object_label){
      .R_m2c = {r.row[0].x, r.row[0].y, r.row[0].z, r.row[1].x, r.row[1].y, r.row[1].z, r.row[2].x,
                r.row[2].y, r.row[2].z},
      .t_m2c = {t.x, t.y, t.z},
      .visib_fract = NAN,
      .instance_id = entity.instance_id,
      .obj_id = entity.obj_id,
      .bbox_visib = {-1, -1, -1, -1},
      .bbox_obj = {-1, -1, -1, -1},
      .px_count_visib = extent->count,
      .px_count_all = -1,
      .px_count_valid = -1,
      .in_view = entity.in_view,
  };
  if (extent->count > 0) {
    out->bbox_visib[0] = extent->x0;
    out->bbox_visib[1] = extent->y0;
    out->bbox_visib[2] = extent->x1 - extent->x0;
    out->bbox_visib[3] = extent->y1 - extent->y0;
  }
}
