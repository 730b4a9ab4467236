/* Interpolates poses over the exposure and checks placements. */
#include "scene/scene.h"

#include "geom/inside.h"

static pl_pose between(const pl_pose *a, const pl_pose *b, double u) {
  const pl_vec3 t = pl_vec3_madd(a->t, u, pl_vec3_sub(b->t, a->t));
  return (pl_pose){t, pl_quat_slerp(a->q, b->q, u)};
}

pl_pose pl_motion_at(const pl_motion *motion, double u) {
  if (motion->keys == NULL)
    return between(&motion->open, &motion->close, u);
  const double at = u * (motion->key_count - 1);
  const int first = (int)fmin(at, motion->key_count - 2);
  return between(&motion->keys[first], &motion->keys[first + 1], at - first);
}

pl_pose pl_motion_middle(const pl_motion *motion) {
  if (motion->keys != NULL)
    return motion->keys[motion->key_count / 2];
  return (pl_pose){
      pl_vec3_scale(pl_vec3_add(motion->open.t, motion->close.t), 0.5),
      pl_quat_slerp(motion->open.q, motion->close.q, 0.5),
  };
}

/* Squares of float coordinates overflow beyond this length. */
#define REACH_M 1e18
/* Smaller objects and bodies have no bounding box in float. */
#define SIZE_MIN_M 1e-9
/* Largest radiometric quantity; sums over lights and samples then stay finite in float. */
#define RADIOMETRY_MAX 1e30

/* Far above practical values; times within a frame stay exact. */
#define SHUTTER_MAX_S 1e12
/* Largest aperture diameter. */
#define APERTURE_MAX_M 100.0

static bool in_reach(pl_vec3 v) {
  return fabs(v.x) <= REACH_M && fabs(v.y) <= REACH_M && fabs(v.z) <= REACH_M;
}

static bool good_pose(const pl_pose *pose) {
  const pl_quat q = pose->q;
  const double n = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  return in_reach(pose->t) && fabs(n - 1.0) < 1e-6;
}

static pl_status check_motion(const char *kind, const char *name, const pl_motion *motion) {
  bool good = good_pose(&motion->open) && good_pose(&motion->close) &&
              (motion->keys == NULL || (motion->key_count >= 3 && motion->key_count % 2 == 1));
  for (int i = 0; good && motion->keys != NULL && i < motion->key_count; i++)
    good = good_pose(&motion->keys[i]);
  if (!good)
    return pl_fail(
        PL_E_RANGE,
        "%s '%s': pose must be finite with a unit quaternion, at most %g m from the root", kind,
        name, REACH_M);
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
  if (!(camera->aperture_m >= 0.0 && camera->aperture_m <= APERTURE_MAX_M) ||
      !(camera->focus_per_m >= 0.0 && camera->focus_per_m * camera->aperture_m <= 1.0))
    return pl_fail(PL_E_RANGE,
                   "camera: the aperture must be 0..%g m, and the distance in focus at least that",
                   APERTURE_MAX_M);
  if (camera->aperture_m > 0.0 && camera->lens.model != NULL &&
      camera->lens.model->angle_max_rad > 0.5 * PL_PI)
    return pl_fail(PL_E_RANGE,
                   "camera: a lens that sees beyond a right angle has no plane of focus");
  PL_TRY(check_motion("camera", "camera", &camera->motion));
  return pl_camera_check_lens(camera);
}

static pl_status check_parameters(const char *what, const char *name, size_t count,
                                  const pl_value *parameters) {
  if (count > 0 && parameters == NULL)
    return pl_fail(PL_E_ARGUMENT, "%s '%s': its materials have no parameters", what, name);
  for (size_t i = 0; i < count; i++)
    for (int k = 0; k < 4; k++)
      if (!isfinite(parameters[i][k]))
        return pl_fail(PL_E_RANGE, "%s '%s': parameter %zu of its materials is not finite", what,
                       name, i);
  return PL_OK;
}

static pl_status check_ground(const char *name, const pl_ground_state *ground) {
  bool valid = fabsf(ground->height_m) <= 1e9f && fabsf(ground->steepness) <= 1e3f &&
               ground->wind_m_s >= 0.0f && ground->wind_m_s <= 1e3f &&
               (isnan(ground->towns_m) || (ground->towns_m >= 0.0f && ground->towns_m <= 1e12f));
  for (int k = 0; k < 3; k++)
    valid = valid && ground->lights[k] >= 0.0f && ground->lights[k] <= (float)RADIOMETRY_MAX &&
            (isnan(ground->water[k]) || (ground->water[k] >= 0.0f && ground->water[k] <= 1.0f));
  if (!valid)
    return pl_fail(
        PL_E_RANGE,
        "body '%s': relief must be at most 1e9 m and 1e3 times as steep as its map, wind "
        "0..1e3 m/s, the albedo of water 0..1, lights 0..%g W m-2 sr-1 in "
        "cells of at most 1e12 m",
        name, RADIOMETRY_MAX);
  return PL_OK;
}

/* The terrain was made for an ellipsoid, which must be the body's. */
static pl_status check_terrain(const pl_body *body, pl_vec3 radii) {
  static const double ALIKE = 1e-9;
  const double r[3] = {radii.x, radii.y, radii.z};
  const pl_vec3 axes[3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  for (int k = 0; body->terrain != NULL && k < 3; k++) {
    const double own = pl_terrain_datum_m(body->terrain, axes[k]);
    if (!(fabs(own - r[k]) <= ALIKE * own))
      return pl_fail(PL_E_RANGE, "body '%s': its radius %d is %.9g m, that of its terrain %.9g m",
                     body->name, k + 1, r[k], own);
  }
  return PL_OK;
}

static pl_status check_body(const pl_body *body, const pl_body_state *state) {
  PL_TRY(check_motion("body", body->name, &state->motion));
  const pl_vec3 r = state->radii_m;
  if (!in_reach(r) || !(r.x >= SIZE_MIN_M) || !(r.y >= SIZE_MIN_M) || !(r.z >= SIZE_MIN_M))
    return pl_fail(PL_E_RANGE, "body '%s': radii must be %g..%g m", body->name, SIZE_MIN_M,
                   REACH_M);
  PL_TRY(check_terrain(body, r));
  for (int k = 0; k < 3; k++)
    if (!(state->albedo[k] >= 0.0f && state->albedo[k] <= 10.0f) ||
        !(state->emission[k] >= 0.0f && state->emission[k] <= (float)RADIOMETRY_MAX))
      return pl_fail(PL_E_RANGE, "body '%s': albedo must be 0..10, emission 0..%g", body->name,
                     RADIOMETRY_MAX);
  if (!(state->contrast >= -1.0f && state->contrast <= 9.0f))
    return pl_fail(PL_E_RANGE, "body '%s': contrast of albedo must be 0..10", body->name);
  PL_TRY(check_ground(body->name, &state->ground));
  const pl_regolith *regolith = &state->regolith;
  bool valid = regolith->limb >= -1.0f && regolith->limb <= 1.0f;
  for (int k = 0; k < 3; k++)
    valid = valid && pl_regolith_band_valid(&regolith->band[k], true);
  if (!valid)
    return pl_fail(PL_E_RANGE, "body '%s': regolith out of range", body->name);
  if (!pl_clouds_valid(&state->clouds))
    return pl_fail(PL_E_RANGE, "body '%s': clouds out of range", body->name);
  return check_parameters("body", body->name, pl_body_parameter_count(body), state->parameters);
}

/* Requires moving nodes to stay within a thousand times the model's extent and the distance from
 * its coordinate origin, so that the limits on the object's position also bound the positions of
 * its parts. */
static pl_status check_movers(const pl_object *object, const pl_object_state *state) {
  const double most = 1e3;
  const float *low = object->model->bounds_min, *high = object->model->bounds_max;
  const size_t movers = pl_object_mover_count(object);
  const pl_vec3 a = pl_model_point(object->model, (pl_vec3){low[0], low[1], low[2]});
  const pl_vec3 b = pl_model_point(object->model, (pl_vec3){high[0], high[1], high[2]});
  const double reach = fmax(fmax(fmax(fabs(a.x), fabs(b.x)), fmax(fabs(a.y), fabs(b.y))),
                            fmax(fabs(a.z), fabs(b.z)));
  if (movers > 0 && state->movers == NULL)
    return pl_fail(PL_E_ARGUMENT, "object '%s': its moving nodes have no motion", object->name);
  const size_t keyed = state->mover_keys != NULL ? movers * (size_t)state->mover_key_count : 0;
  for (size_t k = 0; k < movers + keyed; k++) {
    const size_t i = k % movers;
    const pl_affine *motion = k < movers ? &state->movers[i] : &state->mover_keys[k - movers];
    bool good = pl_vec3_norm(motion->t) <= most * (reach > 0.0 ? reach : 1.0);
    for (int k = 0; k < 3; k++)
      good = good && pl_vec3_norm(motion->m.row[k]) <= most;
    if (!good)
      return pl_fail(PL_E_RANGE,
                     "object '%s': node '%s' moves or grows by more than %g times its model's size",
                     object->name, object->model->nodes.items[object->cut->nodes[i]].name, most);
  }
  return PL_OK;
}

static pl_status check_object(const pl_object *object, const pl_object_state *state) {
  PL_TRY(check_motion("object", object->name, &state->motion));
  const float *low = object->model->bounds_min, *high = object->model->bounds_max;
  double units = 0.0;
  for (int k = 0; k < 3; k++)
    units = fmax(units, (double)high[k] - low[k]);
  const double size_m = state->scale * object->model->unit * units;
  if (!(state->scale > 0.0) || !isfinite(state->scale))
    return pl_fail(PL_E_RANGE, "object '%s': scale must be finite and positive", object->name);
  if (!(size_m >= SIZE_MIN_M && size_m <= REACH_M))
    return pl_fail(PL_E_RANGE, "object '%s': is %.3g m long, must be %g..%g", object->name, size_m,
                   SIZE_MIN_M, REACH_M);
  PL_TRY(check_parameters("object", object->name, pl_object_parameter_count(object),
                          state->parameters));
  return check_movers(object, state);
}

pl_object_state pl_placement_object(const pl_placement *placement, const pl_object *object,
                                    size_t index) {
  if (object->body < 0)
    return placement->objects[index];
  return (pl_object_state){.motion = placement->bodies[object->body].motion, .scale = 1.0};
}

static pl_status check_outside(const pl_object *shape, const pl_object_state *state,
                               pl_vec3 camera) {
  const pl_pose pose = pl_motion_middle(&state->motion);
  const pl_vec3 p = pl_mat3_mul_vec_t(pl_mat3_from_quat(pose.q), pl_vec3_sub(camera, pose.t));
  if (!pl_cover_inside(shape->cover, p).inside)
    return PL_OK;
  return pl_fail(PL_E_RANGE, "the camera is inside the shape of body '%s'", shape->name);
}

pl_status pl_placement_check(const pl_scene *scene, const pl_placement *placement) {
  PL_TRY(check_camera(&placement->camera));
  const pl_vec3 camera = pl_motion_middle(&placement->camera.motion).t;
  for (size_t i = 0; i < scene->body_count; i++)
    PL_TRY(check_body(&scene->bodies[i], &placement->bodies[i]));
  for (size_t i = 0; i < scene->object_count; i++) {
    const pl_object_state state = pl_placement_object(placement, &scene->objects[i], i);
    PL_TRY(check_object(&scene->objects[i], &state));
    if (scene->objects[i].body >= 0)
      PL_TRY(check_outside(&scene->objects[i], &state, camera));
  }
  PL_TRY(pl_volumes_check(placement->volumes, placement->volume_count,
                          scene->craft_count + scene->body_count));
  const pl_shutter *shutter = &placement->shutter;
  if (!(shutter->exposure_s >= 0.0 && shutter->exposure_s <= SHUTTER_MAX_S) ||
      !(shutter->line_s >= 0.0 && shutter->line_s <= SHUTTER_MAX_S))
    return pl_fail(PL_E_RANGE, "shutter: exposure and line time must be 0..%g s", SHUTTER_MAX_S);
  const pl_sun *sun = &placement->sun;
  if (!in_reach(sun->position_m) || !(sun->radius_m > 0.0) || !(sun->radius_m <= REACH_M))
    return pl_fail(PL_E_RANGE, "sun: position and radius must be at most %g m, the radius above 0",
                   REACH_M);
  if (!(sun->irradiance_au >= 0.0 && sun->irradiance_au <= RADIOMETRY_MAX))
    return pl_fail(PL_E_RANGE, "sun: irradiance must be 0..%g W m-2", RADIOMETRY_MAX);
  return PL_OK;
}
