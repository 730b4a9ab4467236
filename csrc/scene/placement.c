/* Poses over the exposure, camera rays, and the check of what a frame places. */
#include "scene/scene.h"

pl_pose pl_motion_middle(const pl_motion *motion) {
  return (pl_pose){
      pl_vec3_scale(pl_vec3_add(motion->open.t, motion->close.t), 0.5),
      pl_quat_slerp(motion->open.q, motion->close.q, 0.5),
  };
}

pl_vec3 pl_camera_ray(const pl_camera *camera, double u, double v) {
  const double y = (v - camera->cy) / camera->fy;
  return (pl_vec3){(u - camera->cx - camera->skew * y) / camera->fx, y, 1.0};
}

static bool finite_vec(pl_vec3 v) { return isfinite(v.x) && isfinite(v.y) && isfinite(v.z); }

static bool good_pose(const pl_pose *pose) {
  const pl_quat q = pose->q;
  const double n = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  return finite_vec(pose->t) && fabs(n - 1.0) < 1e-6;
}

static pl_status check_motion(const char *kind, const char *name, const pl_motion *motion) {
  if (!good_pose(&motion->open) || !good_pose(&motion->close))
    return pl_fail(PL_E_RANGE, "%s '%s': pose must be finite with a unit quaternion", kind, name);
  return PL_OK;
}

static pl_status check_camera(const pl_camera *camera) {
  if (camera->width < 1 || camera->height < 1 || camera->width > 65536 || camera->height > 65536)
    return pl_fail(PL_E_RANGE, "camera: %d x %d pixels, sides must be 1..65536", camera->width,
                   camera->height);
  if (!(camera->fx > 0.0) || !(camera->fy > 0.0) || !isfinite(camera->fx) ||
      !isfinite(camera->fy) || !isfinite(camera->cx) || !isfinite(camera->cy) ||
      !isfinite(camera->skew))
    return pl_fail(PL_E_RANGE, "camera: K must be finite with positive focal lengths");
  return check_motion("camera", "camera", &camera->motion);
}

static pl_status check_body(const pl_body *body, const pl_body_state *state) {
  PL_TRY(check_motion("body", body->name, &state->motion));
  const pl_vec3 r = state->radii_m;
  if (!finite_vec(r) || !(r.x > 0.0) || !(r.y > 0.0) || !(r.z > 0.0))
    return pl_fail(PL_E_RANGE, "body '%s': radii must be finite and positive", body->name);
  for (int k = 0; k < 3; k++)
    if (!(state->albedo[k] >= 0.0f && state->albedo[k] <= 10.0f) ||
        !(state->emission[k] >= 0.0f && isfinite(state->emission[k])))
      return pl_fail(PL_E_RANGE, "body '%s': albedo must be 0..10, emission finite and >= 0",
                     body->name);
  return PL_OK;
}

pl_status pl_placement_check(const pl_scene *scene, const pl_placement *placement) {
  PL_TRY(check_camera(&placement->camera));
  for (size_t i = 0; i < scene->object_count; i++) {
    const pl_object_state *state = &placement->objects[i];
    PL_TRY(check_motion("object", scene->objects[i].name, &state->motion));
    if (!(state->scale > 0.0) || !isfinite(state->scale))
      return pl_fail(PL_E_RANGE, "object '%s': scale must be finite and positive",
                     scene->objects[i].name);
  }
  for (size_t i = 0; i < scene->body_count; i++)
    PL_TRY(check_body(&scene->bodies[i], &placement->bodies[i]));
  const pl_sun *sun = &placement->sun;
  if (!finite_vec(sun->position_m) || !(sun->radius_m > 0.0) || !isfinite(sun->radius_m) ||
      !(sun->irradiance_au >= 0.0) || !isfinite(sun->irradiance_au))
    return pl_fail(PL_E_RANGE, "sun: position, radius and irradiance must be finite, radius > 0");
  return PL_OK;
}
