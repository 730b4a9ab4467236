/* Height fields are as fine as the camera's pixels ask. */
#include "frame/height_fields.h"

#include <string.h>

#include "trace/height_field.h"

/* Samples leave through the edges of pixels and slightly beyond. */
static const double MARGIN_PX = 0.1;

/* Adds the planes through the sides of the image, which lens distortion would bend. */
static void add_sides(const pl_snapshot *shot, const pl_shot_body *body,
                      pl_ground_tile_view *view) {
  const double x0 = -0.5 - MARGIN_PX, x1 = shot->rays.camera.width - 0.5 + MARGIN_PX;
  const double y0 = -0.5 - MARGIN_PX, y1 = shot->rays.camera.height - 0.5 + MARGIN_PX;
  const double corners[4][2] = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  if (shot->rays.camera.lens.model != NULL || shot->rays.camera.aperture_m > 0.0)
    return;
  for (int k = 0; k < 4; k++) {
    const double *a = corners[k], *b = corners[(k + 1) % 4];
    const pl_vec3 normal =
        pl_vec3_cross(pl_snapshot_ray(shot, a[0], a[1]), pl_snapshot_ray(shot, b[0], b[1]));
    view->sides[k] = pl_vec3_unit(pl_mat3_mul_vec_t(body->rotation, normal));
  }
  view->side_count = 4;
}

/* Sets the cone of rays that are not those of pixels. */
static void take_cone(const pl_snapshot *shot, const pl_beam_cone *beams,
                      pl_ground_tile_view *view) {
  view->pixel_rad = beams->pixel_rad;
  view->axis = pl_mat3_mul_vec(shot->camera_to_root, beams->axis);
  view->half_angle_rad = beams->half_angle_rad;
  view->side_count = 0;
}

/* The view of a body's terrain, in body axes. */
static pl_ground_tile_view view_of(const pl_snapshot *shot, const pl_shot_body *body,
                                   const pl_beam_cone *beams) {
  const double image[4] = {-0.5, -0.5, shot->rays.camera.width - 0.5,
                           shot->rays.camera.height - 0.5};
  pl_ground_tile_view view = {
      .eye = body->camera,
      .pixel_rad = 1.0 / fmax(shot->rays.camera.fx, shot->rays.camera.fy),
      .cells_per_pixel = body->body->cells_per_pixel,
      .finest_m = body->body->finest_cell_m,
      .sun_diameter_rad =
          2.0 * asin(fmin(1.0, shot->sun.radius_m / pl_vec3_norm(shot->sun.position))),
      .limit = PL_GROUND_TILE_LIMIT,
  };
  add_sides(shot, body, &view);
  pl_snapshot_cone(shot, image, &view.axis, &view.half_angle_rad);
  if (beams->pixel_rad > 0.0)
    take_cone(shot, beams, &view);
  view.axis = pl_mat3_mul_vec_t(body->rotation, view.axis);
  view.to_sun = pl_vec3_unit(
      pl_mat3_mul_vec_t(body->rotation, pl_vec3_sub(shot->sun.position, body->center)));
  return view;
}

static bool any_terrain(const pl_snapshot *shot) {
  for (size_t i = 0; i < shot->body_count; i++)
    if (shot->bodies[i].has_terrain)
      return true;
  return false;
}

static pl_status place(pl_accelerators *kept, const pl_snapshot *shot, const pl_choice *choice,
                       pl_arena *arena, pl_shot_body *body) {
  if (!body->has_terrain)
    return PL_OK;
  if (choice->terrain_levels == 0) {
    body->has_terrain = false;
    body->outer_m = body->radius_m;
    return pl_shot_check_outside(body);
  }
  pl_ground_tile_view view = view_of(shot, body, &choice->beams);
  view.finest_level = choice->terrain_levels;
  view.far_casters = choice->settings.effects.far_casters > 0;
  view.rays = choice->albedo || (choice->colour && choice->settings.detail.rays);
  return pl_height_field_build(kept, body->body->terrain, &view, choice->threads, choice->cancel,
                               arena, &body->field);
}

pl_status pl_height_fields_place(pl_accelerators *kept, const pl_choice *choice, pl_arena *arena,
                                 pl_snapshot *shot) {
  if (!any_terrain(shot))
    return PL_OK;
  pl_shot_body *bodies = pl_arena_alloc(arena, shot->body_count, sizeof *bodies);
  if (bodies == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for bodies with terrain");
  memcpy(bodies, shot->bodies, shot->body_count * sizeof *bodies);
  for (size_t i = 0; i < shot->body_count; i++)
    PL_TRY(place(kept, shot, choice, arena, &bodies[i]));
  shot->bodies = bodies;
  return PL_OK;
}

void pl_height_fields_report(const pl_accelerators *kept, const pl_snapshot *shot,
                             pl_frame_result *result) {
  result->ground_tiles = 0;
  result->ground_widened = 1.0;
  result->ground_widened_body = NULL;
  result->ground_missed_body = NULL;
  for (size_t i = 0; i < shot->body_count; i++) {
    const pl_height_field *field = shot->bodies[i].field;
    if (field == NULL)
      continue;
    result->ground_tiles += field->count;
    if (field->patch_missed && result->ground_missed_body == NULL)
      result->ground_missed_body = shot->bodies[i].body->name;
    if (field->widened > result->ground_widened) {
      result->ground_widened = field->widened;
      result->ground_widened_body = shot->bodies[i].body->name;
    }
  }
  result->ground_bytes = pl_ground_tiles_used(kept).bytes;
}
