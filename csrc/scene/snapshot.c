/* Transforms the world to camera-relative coordinates. */
#include "scene/snapshot.h"

#include "scene/pieces.h"
#include "scene/volumes.h"
#include "terrain/rock_field.h"

/* IAU 2012 resolution B2. */
#define ASTRONOMICAL_UNIT_M 149597870700.0

pl_vec3 pl_snapshot_ray(const pl_snapshot *snapshot, double u, double v) {
  const pl_ray_source *rays = &snapshot->rays;
  return pl_mat3_mul_vec(snapshot->camera_to_root, rays->kind->at(rays, u, v));
}

void pl_snapshot_rays(const pl_snapshot *shot, int u0, int v, size_t count, double *x, double *y,
                      double *z) {
  const pl_ray_source *rays = &shot->rays;
  if (rays->kind->row != NULL &&
      rays->kind->row(rays, &shot->camera_to_root, u0, v, count, x, y, z))
    return;
  for (size_t i = 0; i < count; i++) {
    const pl_vec3 ray = pl_snapshot_ray(shot, u0 + (double)i, v);
    x[i] = ray.x;
    y[i] = ray.y;
    z[i] = ray.z;
  }
}

bool pl_sphere_in_cone(pl_vec3 center, double radius_m, pl_vec3 axis, double half_angle_rad) {
  const double distance = pl_vec3_norm(center);
  if (distance <= radius_m)
    return true;
  const double along = pl_vec3_dot(center, axis);
  const double across = pl_vec3_norm(pl_vec3_cross(center, axis));
  return atan2(across, along) <= half_angle_rad + asin(radius_m / distance);
}

/* A ray through the point o of the aperture has the direction d - o / F, where d has unit depth: it
 * starts within the aperture radius and deviates by at most asin(radius / F). */
bool pl_snapshot_sees(const pl_snapshot *shot, pl_vec3 center, double radius_m, pl_vec3 axis,
                      double half_angle_rad) {
  const double lens_m = 0.5 * shot->rays.camera.aperture_m;
  const double turn = asin(fmin(1.0, lens_m * shot->rays.camera.focus_per_m));
  return pl_sphere_in_cone(center, radius_m + lens_m, axis, half_angle_rad + turn);
}

double pl_shot_sun_irradiance(const pl_shot_sun *sun, pl_vec3 point) {
  const pl_vec3 to_sun = pl_vec3_sub(sun->position, point);
  return sun->irradiance_au * ASTRONOMICAL_UNIT_M * ASTRONOMICAL_UNIT_M /
         pl_vec3_dot(to_sun, to_sun);
}

/* Samples per side of a rectangle that distortion bends, and the margin for points between them. */
enum { BENT = 8 };
static const double BENT_ROOM = 1.05;

void pl_snapshot_cone(const pl_snapshot *shot, const double rect[4], pl_vec3 *axis,
                      double *half_angle_rad) {
  const bool bent = shot->rays.camera.lens.model != NULL || !shot->rays.kind->projects;
  const int steps = bent ? BENT : 1;
  *axis = pl_snapshot_ray(shot, 0.5 * (rect[0] + rect[2]), 0.5 * (rect[1] + rect[3]));
  *half_angle_rad = 0.0;
  for (int i = 0; i <= steps; i++)
    for (int side = 0; side < 4; side++) {
      const double t = (double)i / steps;
      const double u = side < 2 ? rect[0] + t * (rect[2] - rect[0]) : rect[2 * (side - 2)];
      const double v = side < 2 ? rect[1 + 2 * side] : rect[1] + t * (rect[3] - rect[1]);
      const pl_vec3 ray = pl_snapshot_ray(shot, u, v);
      const double angle = atan2(pl_vec3_norm(pl_vec3_cross(ray, *axis)), pl_vec3_dot(ray, *axis));
      *half_angle_rad = fmax(*half_angle_rad, angle);
    }
  *half_angle_rad *= bent ? BENT_ROOM : 1.0 + 1e-9;
}

static void build_object(const pl_object *object, const pl_object_state *state, pl_vec3 camera,
                         pl_shot_object *out) {
  const pl_pose pose = pl_motion_middle(&state->motion);
  *out = (pl_shot_object){.object = object,
                          .parameters = state->parameters,
                          .scale = state->scale * object->model->unit,
                          .kept = true,
                          .eclipsed = true};
  out->rotation = pl_mat3_from_quat(pose.q);
  out->position = pl_vec3_sub(pose.t, camera);
  const pl_mat3 m = out->rotation;
  const double s = out->scale;
  const pl_vec3 shift = pl_mat3_mul_vec(m, pl_vec3_scale(object->offset, -s));
  const pl_vec3 t = pl_vec3_add(out->position, shift);
  const double columns[12] = {s * m.row[0].x,
                              s * m.row[1].x,
                              s * m.row[2].x,
                              s * m.row[0].y,
                              s * m.row[1].y,
                              s * m.row[2].y,
                              s * m.row[0].z,
                              s * m.row[1].z,
                              s * m.row[2].z,
                              t.x,
                              t.y,
                              t.z};
  for (int i = 0; i < 12; i++)
    out->to_view[i] = (float)columns[i];
  const float *low = object->model->bounds_min, *high = object->model->bounds_max;
  const pl_vec3 middle = {0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]),
                          0.5 * (low[2] + high[2])};
  const pl_vec3 half = {0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1]),
                        0.5 * (high[2] - low[2])};
  const pl_vec3 local = pl_vec3_scale(pl_vec3_sub(middle, object->offset), s);
  out->center = pl_vec3_add(out->position, pl_mat3_mul_vec(m, local));
  out->radius_m = s * pl_vec3_norm(half) * (1.0 + 1e-6);
  if (object->body >= 0 && state->scale * object->reach < s * pl_vec3_norm(half)) {
    out->center = out->position;
    out->radius_m = state->scale * object->reach * (1.0 + 1e-6);
  }
}

pl_status pl_shot_check_outside(const pl_shot_body *body) {
  const double part = pl_vec3_norm(body->camera_unit);
  if (body->body->shape != NULL || body->has_terrain || part > 1.0)
    return PL_OK;
  return pl_fail(PL_E_RANGE, "the camera is inside body '%s' (%.6g of its radius)",
                 body->body->name, part);
}

/* Bounds the surface, and checks that the camera is above it. */
static pl_status place_terrain(pl_shot_body *body) {
  const pl_terrain *terrain = body->body->terrain;
  double low_m, high_m;
  pl_terrain_bounds(terrain, &low_m, &high_m);
  body->outer_m = body->radius_m + fmax(high_m, 0.0) + pl_rock_reach_m(pl_terrain_rocks(terrain));
  const double far = pl_vec3_norm(body->camera);
  if (far > body->outer_m)
    return PL_OK;
  const pl_vec3 up = far > 0.0 ? pl_vec3_scale(body->camera, 1.0 / far) : (pl_vec3){0.0, 0.0, 1.0};
  const int finest = pl_terrain_level_of(terrain, body->body->finest_cell_m);
  const double above_m =
      far - pl_terrain_datum_m(terrain, up) - pl_terrain_height(terrain, up, finest);
  if (above_m > 0.0)
    return PL_OK;
  return pl_fail(PL_E_RANGE, "the camera is %.6g m below the ground of body '%s'", -above_m,
                 body->body->name);
}

static pl_status build_body(const pl_body *body, const pl_body_state *state, pl_vec3 camera,
                            pl_shot_body *out) {
  const pl_pose pose = pl_motion_middle(&state->motion);
  *out = (pl_shot_body){
      .body = body, .state = state, .shadowed = true, .bounced = true, .near_meshes = true};
  out->rotation = pl_mat3_from_quat(pose.q);
  out->center = pl_vec3_sub(pose.t, camera);
  out->camera = pl_mat3_mul_vec_t(out->rotation, pl_vec3_scale(out->center, -1.0));
  const pl_vec3 r = state->radii_m;
  out->radius_m = out->outer_m = fmax(r.x, fmax(r.y, r.z));
  const pl_vec3 scaled = {out->camera.x / r.x, out->camera.y / r.y, out->camera.z / r.z};
  out->camera_unit = scaled;
  out->to_unit = pl_mat3_transpose(out->rotation);
  const double radii[3] = {r.x, r.y, r.z};
  for (int i = 0; i < 3; i++)
    out->to_unit.row[i] = pl_vec3_scale(out->to_unit.row[i], 1.0 / radii[i]);
  out->has_terrain = body->terrain != NULL;
  return out->has_terrain ? place_terrain(out) : pl_shot_check_outside(out);
}

/* Sets whether camera rays may touch a body, its atmosphere, clouds and rings. */
static void look_for_body(const pl_snapshot *shot, pl_vec3 axis, double half_angle,
                          pl_shot_body *body) {
  const pl_air *air = body->body->air;
  body->in_frame = body->body->shape == NULL &&
                   pl_snapshot_sees(shot, body->center, body->outer_m, axis, half_angle);
  body->air_in_frame =
      air != NULL &&
      pl_snapshot_sees(shot, body->center, pl_air_reach_m(air, body->radius_m), axis, half_angle);
  const double clouds_m = body->state->clouds.altitude_m;
  body->clouds_in_frame =
      clouds_m > 0.0 &&
      pl_snapshot_sees(shot, body->center, body->radius_m + clouds_m, axis, half_angle);
  const pl_rings *rings = body->body->rings;
  body->rings_in_frame =
      rings != NULL &&
      pl_snapshot_sees(shot, body->center, pl_rings_outer_m(rings), axis, half_angle);
}

static pl_status place_objects(const pl_scene *scene, const pl_placement *placement,
                               pl_arena *arena, pl_vec3 axis, double half_angle, pl_snapshot *out) {
  pl_shot_object *objects = pl_arena_alloc(arena, scene->object_count, sizeof *objects);
  if (objects == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the snapshot");
  for (size_t i = 0; i < scene->object_count; i++) {
    pl_shot_object *object = &objects[i];
    const pl_object_state state = pl_placement_object(placement, &scene->objects[i], i);
    build_object(&scene->objects[i], &state, out->camera_position, object);
    object->id = pl_surface_make(i < scene->craft_count ? PL_SURFACE_MESH : PL_SURFACE_SHAPE, i);
    if (scene->objects[i].cut != NULL)
      PL_TRY(pl_pieces_place(&placement->objects[i], arena, object));
    object->in_frame = pl_snapshot_sees(out, object->center, object->radius_m, axis, half_angle);
  }
  out->objects = objects;
  return PL_OK;
}

/* Called after the objects are placed, since some of them are shapes of bodies. */
static pl_status place_bodies(const pl_scene *scene, const pl_placement *placement, pl_arena *arena,
                              pl_vec3 axis, double half_angle, pl_snapshot *out) {
  pl_shot_body *bodies = pl_arena_alloc(arena, scene->body_count, sizeof *bodies);
  if (bodies == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the snapshot");
  for (size_t i = 0; i < scene->body_count; i++) {
    PL_TRY(build_body(&scene->bodies[i], &placement->bodies[i], out->camera_position, &bodies[i]));
    look_for_body(out, axis, half_angle, &bodies[i]);
  }
  for (size_t i = scene->craft_count; i < scene->object_count; i++)
    bodies[scene->objects[i].body].shape = &out->objects[i];
  out->bodies = bodies;
  return PL_OK;
}

static pl_status index_spheres(pl_arena *arena, pl_snapshot *out) {
  const size_t most = out->object_count > out->body_count ? out->object_count : out->body_count;
  pl_sphere *leaves = pl_arena_alloc(arena, most, sizeof *leaves);
  if (leaves == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the snapshot");
  for (size_t i = 0; i < out->object_count; i++)
    leaves[i] = (pl_sphere){.center = out->objects[i].center, .radius_m = out->objects[i].radius_m};
  PL_TRY(pl_sphere_tree_build(arena, leaves, out->object_count, &out->object_tree));
  for (size_t i = 0; i < out->body_count; i++)
    leaves[i] = (pl_sphere){.center = out->bodies[i].center, .radius_m = out->bodies[i].radius_m};
  return pl_sphere_tree_build(arena, leaves, out->body_count, &out->body_tree);
}

pl_status pl_snapshot_build(const pl_scene *scene, const pl_placement *placement, pl_arena *arena,
                            pl_snapshot *out) {
  const pl_pose camera = pl_motion_middle(&placement->camera.motion);
  *out = (pl_snapshot){
      .levels = scene->levels,
      .craft_count = scene->craft_count,
      .rays = pl_ray_source_of_camera(&placement->camera, &placement->shutter),
      .camera_to_root = pl_mat3_from_quat(camera.q),
      .camera_position = camera.t,
      .object_count = scene->object_count,
      .body_count = scene->body_count,
      .sun = {.position = pl_vec3_sub(placement->sun.position_m, camera.t),
              .radius_m = placement->sun.radius_m,
              .irradiance_au = placement->sun.irradiance_au},
  };
  for (int band = 0; band < 3; band++)
    out->sun.wavelengths_um[band] = placement->sun.wavelengths_um[band];
  if (!(pl_vec3_norm(out->sun.position) > out->sun.radius_m))
    return pl_fail(PL_E_RANGE, "the camera is inside the sun");
  pl_vec3 axis;
  double half_angle;
  const double image[4] = {-0.5, -0.5, out->rays.camera.width - 0.5, out->rays.camera.height - 0.5};
  pl_snapshot_cone(out, image, &axis, &half_angle);
  out->sun.in_frame = pl_snapshot_sees(out, out->sun.position, out->sun.radius_m, axis, half_angle);
  PL_TRY(place_objects(scene, placement, arena, axis, half_angle, out));
  PL_TRY(place_bodies(scene, placement, arena, axis, half_angle, out));
  PL_TRY(index_spheres(arena, out));
  return pl_volumes_place(placement, arena, axis, half_angle, out);
}
