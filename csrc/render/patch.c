/* Assignment of hits to patches. */
#include "render/patch.h"

#include "geom/ellipsoid.h"
#include "scene/shot_frame.h"

static pl_vec3f facet_normal(const pl_shot_object *object, uint32_t triangle) {
  const pl_model *model = object->object->model;
  const uint32_t *corner = model->indices + 3 * (size_t)triangle;
  const float *a = model->positions + 3 * (size_t)corner[0];
  const pl_shot_piece *piece = pl_shot_piece_of(object, triangle);
  const float *to_view = piece != NULL ? piece->to_view : object->to_view;
  return pl_vec3f_across(pl_shot_edge(to_view, a, model->positions + 3 * (size_t)corner[1]),
                         pl_shot_edge(to_view, a, model->positions + 3 * (size_t)corner[2]));
}

/* `point`: relative to the body's centre. */
static pl_vec3f body_normal(const pl_shot_body *body, pl_vec3 point) {
  const pl_vec3 local = pl_mat3_mul_vec_t(body->rotation, point);
  return pl_vec3_to_float(
      pl_mat3_mul_vec(body->rotation, pl_ellipsoid_normal(body->state->radii_m, local)));
}

static pl_spot spot_at(const pl_snapshot *shot, const pl_hit *hit, pl_vec3 direction) {
  const pl_vec3 point = pl_vec3_scale(direction, hit->t);
  pl_spot spot = {.surface_id = hit->surface_id, .range_m = (float)hit->t};
  if (pl_surface_is_mesh(hit->surface_id)) {
    const pl_shot_object *object = pl_shot_object_of(shot, hit->surface_id);
    spot.point = pl_vec3_to_float(pl_vec3_sub(point, object->center));
    spot.part = pl_object_part(object->object, hit->triangle);
    spot.normal = facet_normal(object, hit->triangle);
  } else {
    const pl_shot_body *body = pl_shot_body_of(shot, hit->surface_id);
    const pl_vec3 from_center = pl_vec3_sub(point, body->center);
    spot.point = pl_vec3_to_float(from_center);
    spot.normal = body_normal(body, from_center);
  }
  return spot;
}

uint32_t pl_patch_meet(pl_pixel_patches *patches, const pl_snapshot *shot, const pl_hit *hit,
                       pl_vec3 direction, float spread) {
  for (uint32_t i = 0; i < patches->count; i++) {
    pl_patch *patch = &patches->patch[i];
    if (patch->triangle == hit->triangle &&
        pl_surface_same(patch->spot.surface_id, hit->surface_id))
      return patch->seen++, i;
  }
  const pl_spot met = spot_at(shot, hit, direction);
  const float depth_m = pl_spot_depth(&met, spread);
  for (uint32_t i = 0; i < patches->count; i++) {
    pl_patch *patch = &patches->patch[i];
    if (!pl_spot_fits(&patch->spot, &met, depth_m))
      continue;
    patch->triangle = hit->triangle;
    return patch->seen++, i;
  }
  if (patches->count == PL_PATCHES)
    return PL_PATCH_NONE;
  patches->patch[patches->count] = (pl_patch){.spot = met, .triangle = hit->triangle, .seen = 1};
  return patches->count++;
}
