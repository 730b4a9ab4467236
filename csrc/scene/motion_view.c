/* Upper bounds of image motion while the shutter is open, summed from key to key. */
#include "scene/shutter.h"

#include "terrain/ground_distance.h"

/* Bounding sphere that moves with an entity, and its motion relative to the entity. */
typedef struct mover {
  const pl_motion *motion;
  pl_vec3 local; /* centre in the entity's axes, m */
  double radius_m;
  double inner_m; /* largest displacement of its parts relative to the entity between two keys, m */
  double glint_rad; /* width of its narrowest specular highlights; infinite without any */
} mover;

/* Two instants, and the camera's motion between them. */
typedef struct step {
  pl_pose from, to;
  pl_vec3 sun_from, sun_to;
  double turn_rad;       /* rotation of the camera */
  double half_angle_rad; /* largest angle between the image's corners and the axis */
  double px_per_rad;     /* upper bound */
} step;

static double turn_rad(pl_quat a, pl_quat b) {
  const double x = a.w * b.x - a.x * b.w - a.y * b.z + a.z * b.y;
  const double y = a.w * b.y - a.y * b.w - a.z * b.x + a.x * b.z;
  const double z = a.w * b.z - a.z * b.w - a.x * b.y + a.y * b.x;
  const double w = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
  return 2.0 * atan2(sqrt(x * x + y * y + z * z), fabs(w));
}

static double angle_between(pl_vec3 a, pl_vec3 b) {
  return atan2(pl_vec3_norm(pl_vec3_cross(a, b)), pl_vec3_dot(a, b));
}

static pl_vec3 center_of(const mover *mover, const pl_pose *pose) {
  return pl_vec3_add(pose->t, pl_mat3_mul_vec(pl_mat3_from_quat(pose->q), mover->local));
}

/* Returns whether the sphere may be visible at any time between the instants. */
static bool may_be_seen(const step *step, pl_vec3 from, pl_vec3 to, double radius_m) {
  const pl_mat3 axes = pl_mat3_from_quat(step->from.q);
  const pl_vec3 axis = pl_mat3_mul_vec(axes, (pl_vec3){0.0, 0.0, 1.0});
  const double way = pl_vec3_norm(pl_vec3_sub(to, from));
  return pl_sphere_in_cone(from, radius_m + way, axis, step->half_angle_rad + step->turn_rad);
}

/* Returns an upper bound of the image motion in pixels of any visible point of the sphere. The
 * smaller one of two bounds is used: motion in camera axes is small when the camera rotates with
 * its target, motion in root axes when only the camera rotates. */
static double sphere_px(const step *step, const mover *mover, const pl_pose *from,
                        const pl_pose *to) {
  const pl_vec3 a = pl_vec3_sub(center_of(mover, from), step->from.t);
  const pl_vec3 b = pl_vec3_sub(center_of(mover, to), step->to.t);
  if (!may_be_seen(step, a, b, mover->radius_m + mover->inner_m))
    return 0.0;
  const double nearest = fmin(pl_vec3_norm(a), pl_vec3_norm(b)) - mover->radius_m;
  const double own = turn_rad(from->q, to->q);
  const pl_quat qa = pl_quat_mul(pl_quat_conjugate(step->from.q), from->q);
  const pl_quat qb = pl_quat_mul(pl_quat_conjugate(step->to.q), to->q);
  const pl_vec3 in_a = pl_mat3_mul_vec_t(pl_mat3_from_quat(step->from.q), a);
  const pl_vec3 in_b = pl_mat3_mul_vec_t(pl_mat3_from_quat(step->to.q), b);
  const double by_camera =
      pl_vec3_norm(pl_vec3_sub(in_b, in_a)) + turn_rad(qa, qb) * mover->radius_m + mover->inner_m;
  const double by_root = pl_vec3_norm(pl_vec3_sub(b, a)) + own * mover->radius_m + mover->inner_m;
  if (!(by_camera > 0.0))
    return 0.0;
  if (!(nearest > 0.0))
    return INFINITY;
  double px = step->px_per_rad * fmin(by_camera / nearest, step->turn_rad + by_root / nearest);
  if (isfinite(mover->glint_rad)) {
    const double lit = angle_between(step->sun_from, step->sun_to) + angle_between(a, b);
    px = fmax(px, (2.0 * own + lit) / mover->glint_rad);
  }
  return px;
}

/* Returns the largest displacement of a part relative to its object between two keys, m. */
static double inner_step_m(const pl_object *object, const pl_object_state *state, int key) {
  const size_t count = pl_object_mover_count(object);
  const float *low = object->model->bounds_min, *high = object->model->bounds_max;
  double most = 0.0;
  for (size_t i = 0; state->mover_keys != NULL && i < 8 * count; i++) {
    const pl_affine *a = state->mover_keys + (size_t)key * count + i / 8;
    const pl_vec3 corner = {i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1],
                            i & 4 ? high[2] : low[2]};
    const pl_vec3 p = pl_model_point(object->model, corner);
    const pl_vec3 from = pl_vec3_add(pl_mat3_mul_vec(a->m, p), a->t);
    const pl_vec3 to = pl_vec3_add(pl_mat3_mul_vec(a[count].m, p), a[count].t);
    most = fmax(most, pl_vec3_norm(pl_vec3_sub(to, from)));
  }
  return most * state->scale;
}

static step step_of(const pl_placement *placement, const pl_snapshot *shot, int key, int keys) {
  const double u0 = (double)key / (keys - 1), u1 = (double)(key + 1) / (keys - 1);
  const pl_motion *camera = &placement->camera.motion;
  step step = {.from = pl_motion_at(camera, u0), .to = pl_motion_at(camera, u1)};
  const pl_sun *sun = &placement->sun;
  step.sun_from = pl_vec3_sub(sun->keys != NULL ? sun->keys[key] : sun->position_m, step.from.t);
  step.sun_to = pl_vec3_sub(sun->keys != NULL ? sun->keys[key + 1] : sun->position_m, step.to.t);
  step.turn_rad = turn_rad(step.from.q, step.to.q);
  const double image[4] = {-0.5, -0.5, shot->rays.camera.width - 0.5,
                           shot->rays.camera.height - 0.5};
  pl_vec3 axis;
  pl_snapshot_cone(shot, image, &axis, &step.half_angle_rad);
  const pl_vec3 forward = pl_mat3_mul_vec(shot->camera_to_root, (pl_vec3){0.0, 0.0, 1.0});
  step.half_angle_rad += angle_between(axis, forward);
  const double cosine = fmax(0.1, cos(step.half_angle_rad));
  const double scale = placement->camera.lens.model != NULL ? 1.0 : 1.0 / (cosine * cosine);
  step.px_per_rad = fmax(shot->rays.camera.fx, shot->rays.camera.fy) * scale;
  return step;
}

static double object_px(const pl_placement *placement, const pl_snapshot *shot, size_t i,
                        const step *step, int key, double u[2]) {
  const pl_shot_object *object = &shot->objects[i];
  const pl_object_state state = pl_placement_object(placement, object->object, i);
  const double alpha = object->object->summary.ggx_alpha_min;
  const mover mover = {
      .motion = &state.motion,
      .local = pl_mat3_mul_vec_t(object->rotation, pl_vec3_sub(object->center, object->position)),
      .radius_m = object->radius_m,
      .inner_m = inner_step_m(object->object, &state, key),
      .glint_rad =
          alpha < 1.0 ? alpha + shot->sun.radius_m / pl_vec3_norm(shot->sun.position) : INFINITY,
  };
  const pl_pose from = pl_motion_at(mover.motion, u[0]), to = pl_motion_at(mover.motion, u[1]);
  return sphere_px(step, &mover, &from, &to);
}

/* A camera over terrain: seen from it, the camera moves and turns over ground that stands still.
 * `clear_m`: no ground is nearer in the middle of the exposure. */
static double ground_px(const pl_placement *placement, const pl_snapshot *shot, size_t i,
                        const step *step, double u[2], double clear_m) {
  const pl_shot_body *body = &shot->bodies[i];
  const pl_motion *motion = &placement->bodies[i].motion;
  const pl_pose from = pl_motion_at(motion, u[0]), to = pl_motion_at(motion, u[1]);
  const pl_vec3 a = pl_vec3_sub(from.t, step->from.t), b = pl_vec3_sub(to.t, step->to.t);
  if (!may_be_seen(step, a, b, body->outer_m))
    return 0.0;
  const pl_vec3 eye_a = pl_vec3_scale(pl_mat3_mul_vec_t(pl_mat3_from_quat(from.q), a), -1.0);
  const pl_vec3 eye_b = pl_vec3_scale(pl_mat3_mul_vec_t(pl_mat3_from_quat(to.q), b), -1.0);
  const double way = pl_vec3_norm(pl_vec3_sub(eye_b, eye_a));
  const double off = fmax(pl_vec3_norm(pl_vec3_sub(eye_a, body->camera)),
                          pl_vec3_norm(pl_vec3_sub(eye_b, body->camera)));
  const double turn = turn_rad(pl_quat_mul(pl_quat_conjugate(step->from.q), from.q),
                               pl_quat_mul(pl_quat_conjugate(step->to.q), to.q));
  if (!(way > 0.0))
    return step->px_per_rad * turn;
  return clear_m > off ? step->px_per_rad * (turn + way / (clear_m - off)) : INFINITY;
}

static double body_px(const pl_placement *placement, const pl_snapshot *shot, size_t i,
                      const step *step, double u[2]) {
  const mover mover = {.motion = &placement->bodies[i].motion,
                       .radius_m = shot->bodies[i].radius_m,
                       .glint_rad = INFINITY};
  const pl_pose from = pl_motion_at(mover.motion, u[0]), to = pl_motion_at(mover.motion, u[1]);
  return sphere_px(step, &mover, &from, &to);
}

/* Returns the distance of a point from rings about `center` with the normal `axis`. */
static double rings_gap_m(const pl_rings *rings, pl_vec3 center, pl_vec3 axis) {
  const double height = pl_vec3_dot(center, axis);
  const double across = pl_vec3_norm(pl_vec3_madd(center, -height, axis));
  const double in = pl_rings_inner_m(rings) - across, out = across - pl_rings_outer_m(rings);
  return hypot(height, fmax(0.0, fmax(in, out)));
}

/* Rings are axisymmetric: rotation about their axis moves nothing. */
static double rings_px(const pl_rings *rings, const pl_motion *motion, const step *step,
                       double u[2]) {
  const pl_pose from = pl_motion_at(motion, u[0]), to = pl_motion_at(motion, u[1]);
  const pl_vec3 z = {0.0, 0.0, 1.0}, a = pl_vec3_sub(from.t, step->from.t),
                b = pl_vec3_sub(to.t, step->to.t);
  const double outer_m = pl_rings_outer_m(rings);
  if (!may_be_seen(step, a, b, outer_m))
    return 0.0;
  const pl_mat3 eye_a = pl_mat3_from_quat(step->from.q), eye_b = pl_mat3_from_quat(step->to.q);
  const pl_vec3 axis_a = pl_mat3_mul_vec(pl_mat3_from_quat(from.q), z);
  const pl_vec3 axis_b = pl_mat3_mul_vec(pl_mat3_from_quat(to.q), z);
  const double turn_seen =
      angle_between(pl_mat3_mul_vec_t(eye_a, axis_a), pl_mat3_mul_vec_t(eye_b, axis_b));
  const double by_camera =
      pl_vec3_norm(pl_vec3_sub(pl_mat3_mul_vec_t(eye_b, b), pl_mat3_mul_vec_t(eye_a, a))) +
      turn_seen * outer_m;
  const double by_root = pl_vec3_norm(pl_vec3_sub(b, a)) + angle_between(axis_a, axis_b) * outer_m;
  const double nearest = fmin(rings_gap_m(rings, a, axis_a), rings_gap_m(rings, b, axis_b));
  if (!(by_camera > 0.0))
    return 0.0;
  if (!(nearest > 0.0))
    return INFINITY;
  return step->px_per_rad * fmin(by_camera / nearest, step->turn_rad + by_root / nearest);
}

/* Volumes move with their parent entities. */
static double volume_px(const pl_placement *placement, const pl_snapshot *shot, size_t i,
                        const step *step, double u[2]) {
  const pl_shot_volume *volume = &shot->volumes[i];
  const size_t parent = volume->volume->parent;
  const bool on_object = parent < shot->craft_count;
  const pl_motion *motion = on_object ? &placement->objects[parent].motion
                                      : &placement->bodies[parent - shot->craft_count].motion;
  const pl_pose middle = pl_motion_middle(motion), from = pl_motion_at(motion, u[0]),
                to = pl_motion_at(motion, u[1]);
  const pl_vec3 at = pl_vec3_sub(pl_vec3_add(volume->center, shot->camera_position), middle.t);
  const mover mover = {.motion = motion,
                       .local = pl_quat_rotate_inverse(middle.q, at),
                       .radius_m = volume->radius_m,
                       .glint_rad = INFINITY};
  return sphere_px(step, &mover, &from, &to);
}

/* The body whose ground was measured last. */
typedef struct measured {
  const pl_shot_body *body;
  double clear_m;
} measured;

static double clear_of(const pl_shot_body *body, measured *last) {
  if (last->body != body)
    *last = (measured){body, pl_ground_distance_m(body->body->terrain, body->camera)};
  return last->clear_m;
}

static double step_px(const pl_placement *placement, const pl_snapshot *shot, bool sky, int key,
                      int keys, measured *last) {
  const step step = step_of(placement, shot, key, keys);
  double u[2] = {(double)key / (keys - 1), (double)(key + 1) / (keys - 1)}, most = 0.0;
  for (size_t i = 0; i < shot->object_count; i++)
    most = fmax(most, object_px(placement, shot, i, &step, key, u));
  for (size_t i = 0; i < shot->body_count; i++)
    if (shot->bodies[i].has_terrain)
      most = fmax(most, ground_px(placement, shot, i, &step, u, clear_of(&shot->bodies[i], last)));
    else if (shot->bodies[i].shape == NULL)
      most = fmax(most, body_px(placement, shot, i, &step, u));
  for (size_t i = 0; i < shot->body_count; i++)
    if (shot->bodies[i].body->rings != NULL)
      most =
          fmax(most, rings_px(shot->bodies[i].body->rings, &placement->bodies[i].motion, &step, u));
  for (size_t i = 0; i < shot->volume_count; i++)
    most = fmax(most, volume_px(placement, shot, i, &step, u));
  if (may_be_seen(&step, step.sun_from, step.sun_to, shot->sun.radius_m))
    most =
        fmax(most, step.px_per_rad * (step.turn_rad + angle_between(step.sun_from, step.sun_to)));
  return sky ? fmax(most, step.px_per_rad * step.turn_rad) : most;
}

void pl_shutter_measure(const pl_placement *placement, const pl_snapshot *shot, bool sky,
                        pl_view *view) {
  const pl_shutter *shutter = &placement->shutter;
  const double window_s = pl_shutter_window_s(placement);
  const pl_motion *camera = &placement->camera.motion;
  const int keys = camera->keys != NULL ? camera->key_count : 2;
  double total = 0.0, fastest = 0.0;
  measured last = {.body = NULL};
  view->blur_px = view->skew_px = 0.0;
  if (!(window_s > 0.0))
    return;
  for (int key = 0; key + 1 < keys; key++) {
    const double px = shutter->held ? INFINITY : step_px(placement, shot, sky, key, keys, &last);
    total += px;
    fastest = fmax(fastest, px * (keys - 1) / window_s);
  }
  const double rows_s = window_s - shutter->exposure_s;
  if (shutter->exposure_s > 0.0)
    view->blur_px = fmin(total, fastest * shutter->exposure_s);
  if (rows_s > 0.0)
    view->skew_px = fmin(total, fastest * rows_s);
}
