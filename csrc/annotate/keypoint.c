#include "annotate/keypoint.h"

#include "render/geometry.h"

pl_status pl_keypoints_check(const pl_scene *scene, const pl_keypoint *keypoints, size_t count) {
  for (size_t i = 0; i < count; i++) {
    const pl_keypoint *k = &keypoints[i];
    const bool on_object = k->owner < scene->craft_count;
    const size_t movers = on_object ? pl_object_mover_count(&scene->objects[k->owner]) : 0;
    if (k->owner >= scene->craft_count + scene->body_count || k->mover < 0 ||
        (size_t)k->mover > movers)
      return pl_fail(PL_E_ARGUMENT, "keypoint %zu: no object or body %zu with a moving node %d", i,
                     k->owner, k->mover);
  }
  return PL_OK;
}

/* A point in the frame of an object at rest. */
static pl_sight on_object(const pl_scene *scene, const pl_sight_frame *frame, size_t index,
                          pl_vec3 place) {
  const pl_object *object = &scene->objects[index];
  const pl_object_state state = pl_placement_object(frame->placement, object, index);
  const double unit_m = state.scale * object->model->unit;
  const pl_surface_kind kind = object->body < 0 ? PL_SURFACE_MESH : PL_SURFACE_SHAPE;
  return (pl_sight){.is_point = true,
                    .surface_id = pl_surface_make(kind, index),
                    .local = pl_vec3_madd(object->offset, 1.0 / unit_m, place),
                    .object = object,
                    .index = index};
}

static pl_sight on_body(const pl_scene *scene, const pl_sight_frame *frame, size_t index,
                        pl_vec3 place) {
  const pl_shot_body *body = &frame->shot->bodies[index];
  const pl_vec3 r = body->state->radii_m;
  for (size_t i = scene->craft_count; i < scene->object_count; i++)
    if (scene->objects[i].body == (int)index)
      return on_object(scene, frame, i, place);
  pl_sight s = {.is_point = true,
                .surface_id = pl_shot_surface_of(body, index),
                .local = place,
                .index = index,
                .radii = r};
  if (!body->has_terrain)
    s.normal = (pl_vec3){place.x / (r.x * r.x), place.y / (r.y * r.y), place.z / (r.z * r.z)};
  return s;
}

void pl_keypoint_find(const pl_scene *scene, const pl_sight_frame *frame, const pl_keypoint *k,
                      pl_keypoint_label *out) {
  pl_sight s = k->owner < scene->craft_count
                   ? on_object(scene, frame, k->owner, k->place)
                   : on_body(scene, frame, k->owner - scene->craft_count, k->place);
  pl_geometry_label met;
  pl_sight_memo memo = {0};
  pl_vec3 point;
  s.piece = (size_t)k->mover;
  s.deep_m = k->deep_m;
  *out = (pl_keypoint_label){.xy = {NAN, NAN}};
  const bool imaged = pl_sight_project(frame, &s, &memo, &point, out->xy);
  out->position[0] = point.x;
  out->position[1] = point.y;
  out->position[2] = point.z;
  if (!imaged)
    out->xy[0] = out->xy[1] = NAN;
  if (!imaged || !pl_pixel_in_image(&frame->shot->rays.camera, out->xy))
    return;
  const pl_surface_id by = pl_sight_hidden_by(frame, &s, &memo);
  out->visible = pl_surface_is_none(by) ? PL_KEYPOINT_SEEN : PL_KEYPOINT_HIDDEN;
  if (pl_surface_is_none(by))
    return;
  pl_geometry_of(by)->label(frame->shot, by, &met);
  out->occluded_by = met.instance_id;
}
