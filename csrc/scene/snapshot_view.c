/* The plan's view of a snapshot, and culling by it. */
#include "scene/snapshot.h"

static void set_center(pl_view_thing *thing, pl_vec3 center) {
  thing->center_m[0] = center.x;
  thing->center_m[1] = center.y;
  thing->center_m[2] = center.z;
  thing->distance_m = pl_vec3_norm(center);
}

static pl_view_thing object_thing(const pl_snapshot *shot, const pl_shot_object *object) {
  const pl_model_summary *summary = &object->object->summary;
  pl_view_thing thing = {
      .in_frame = object->in_frame,
      .textured = summary->textured,
      .radius_m = object->radius_m,
      .albedo_max = summary->albedo_max,
      .ggx_alpha_min = summary->ggx_alpha_min,
      .irradiance = pl_shot_sun_irradiance(&shot->sun, object->center),
      .emission_max = summary->emission_max,
  };
  set_center(&thing, object->center);
  return thing;
}

static pl_view_thing body_thing(const pl_snapshot *shot, const pl_shot_body *body) {
  const pl_body_state *state = body->state;
  pl_view_thing thing = {
      .is_body = true,
      .in_frame = body->in_frame,
      .textured = body->body->map != NULL,
      .radius_m = body->radius_m,
      .albedo_max = fmax(state->albedo[0], fmax(state->albedo[1], state->albedo[2])),
      .ggx_alpha_min = 1.0,
      .irradiance = pl_shot_sun_irradiance(&shot->sun, body->center),
      .emission_max = fmax(state->emission[0], fmax(state->emission[1], state->emission[2])),
  };
  set_center(&thing, body->center);
  return thing;
}

pl_status pl_snapshot_view(const pl_snapshot *shot, pl_arena *arena, pl_view *out) {
  const size_t count = shot->object_count + shot->body_count;
  pl_view_thing *things = pl_arena_alloc(arena, count, sizeof *things);
  if (things == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the view");
  for (size_t i = 0; i < shot->object_count; i++)
    things[i] = object_thing(shot, &shot->objects[i]);
  for (size_t i = 0; i < shot->body_count; i++)
    things[shot->object_count + i] = body_thing(shot, &shot->bodies[i]);
  const pl_vec3 sun = shot->sun.position;
  const pl_vec3 direction = pl_vec3_unit(sun);
  const double distance = pl_vec3_norm(sun);
  *out = (pl_view){
      .width = shot->camera.width,
      .height = shot->camera.height,
      .pixel_rad = 1.0 / fmax(shot->camera.fx, shot->camera.fy),
      .sun_radius_rad = asin(fmin(1.0, shot->sun.radius_m / distance)),
      .sun_direction = {direction.x, direction.y, direction.z},
      .sun_in_frame = shot->sun.in_frame,
      .things = things,
      .thing_count = count,
  };
  return PL_OK;
}

/* Whether leaving `thing` out can change anything in the frame by more than the tolerance. */
static bool matters(const pl_view *view, const pl_view_thing *thing, double tolerance_dn) {
  for (size_t i = 0; i < view->thing_count; i++) {
    const pl_view_thing *seen = &view->things[i];
    if (seen == thing || !seen->in_frame)
      continue;
    if (pl_view_shadow_reaches(view, thing, seen))
      return true;
    /* A glossy surface shows a small thing as bright as a large one. */
    const double factor = seen->ggx_alpha_min < 0.5 ? 1.0 : pl_view_factor(seen, thing);
    const double radiance =
        thing->albedo_max * seen->albedo_max * thing->irradiance / PL_PI * factor;
    if (pl_view_dn(view, radiance) > tolerance_dn)
      return true;
  }
  return false;
}

static bool is_shadowed(const pl_view *view, const pl_view_thing *receiver, double tolerance_dn) {
  double hidden = 0.0;
  for (size_t i = 0; i < view->thing_count; i++)
    if (&view->things[i] != receiver)
      hidden += pl_view_hidden_sun(view, &view->things[i], receiver);
  return pl_view_dn_dimming(hidden) > tolerance_dn;
}

void pl_snapshot_cull(pl_snapshot *shot, const pl_view *view, double tolerance_dn) {
  for (size_t i = 0; i < shot->object_count; i++) {
    pl_shot_object *object = &shot->objects[i];
    object->kept = object->in_frame || matters(view, &view->things[i], tolerance_dn);
  }
  for (size_t i = 0; i < shot->body_count; i++)
    shot->bodies[i].shadowed =
        is_shadowed(view, &view->things[shot->object_count + i], tolerance_dn);
}
