#include "annotate/sight.h"

#include "render/geometry.h"
#include "scene/shutter.h"

/* --- places ----------------------------------------------------------------------------------- */

static pl_affine rigid(pl_pose pose, pl_vec3 camera) {
  return (pl_affine){pl_mat3_from_quat(pose.q), pl_vec3_sub(pose.t, camera)};
}

/* Motion of a moving node at the fraction u of the frame's time, as pl_placement_at has it. */
static pl_affine mover_at(const pl_object_state *state, size_t count, size_t mover, double u) {
  if (state->mover_keys == NULL)
    return state->movers[mover];
  const double at = u * (state->mover_key_count - 1);
  const int first = (int)fmin(at, state->mover_key_count - 2);
  const pl_affine *a = &state->mover_keys[(size_t)first * count + mover], *b = a + count;
  pl_affine out;
  for (int k = 0; k < 3; k++)
    out.m.row[k] = pl_vec3_madd(a->m.row[k], at - first, pl_vec3_sub(b->m.row[k], a->m.row[k]));
  out.t = pl_vec3_madd(a->t, at - first, pl_vec3_sub(b->t, a->t));
  return out;
}

/* The same transforms as scene/snapshot.c and scene/pieces.c, at any time. */
static pl_affine object_at(const pl_placement *placement, const pl_sight *s, double u,
                           pl_vec3 camera) {
  const pl_object_state state = pl_placement_object(placement, s->object, s->index);
  const double scale = state.scale * s->object->model->unit;
  const pl_affine out = rigid(pl_motion_at(&state.motion, u), camera);
  pl_affine mesh = PL_AFFINE_IDENTITY;
  if (s->piece > 0) {
    const size_t movers = pl_object_mover_count(s->object);
    const pl_affine motion = mover_at(&state, movers, s->piece - 1, u);
    mesh = pl_model_mesh_motion(s->object->model, &motion);
  }
  mesh.t = pl_vec3_scale(pl_vec3_sub(mesh.t, s->object->offset), scale);
  for (int k = 0; k < 3; k++)
    mesh.m.row[k] = pl_vec3_scale(mesh.m.row[k], scale);
  return pl_affine_compose(&out, &mesh);
}

/* A body that grows carries its surface with it. */
static pl_affine body_at(const pl_placement *placement, const pl_sight *s, double u,
                         pl_vec3 camera) {
  const pl_body_state *state = &placement->bodies[s->index];
  pl_affine out = rigid(pl_motion_at(&state->motion, u), camera);
  const pl_vec3 a = s->radii, b = state->radii_m;
  for (int k = 0; k < 3; k++) {
    out.m.row[k].x *= b.x / a.x;
    out.m.row[k].y *= b.y / a.y;
    out.m.row[k].z *= b.z / a.z;
  }
  return out;
}

static pl_carrier carrier_at(const pl_placement *placement, const pl_sight *s, double u) {
  const pl_pose camera = pl_motion_at(&placement->camera.motion, u);
  pl_carrier out = {PL_AFFINE_IDENTITY, pl_mat3_from_quat(camera.q)};
  if (s->is_point)
    out.place = s->object != NULL ? object_at(placement, s, u, camera.t)
                                  : body_at(placement, s, u, camera.t);
  return out;
}

/* The carrier to the middle of a frame's exposure. */
static const pl_carrier *carry(const pl_sight_frame *frame, const pl_sight *s,
                               pl_sight_memo *memo) {
  if (!memo->has_carrier || memo->carried_piece != s->piece ||
      !pl_surface_same(memo->carried_id, s->surface_id)) {
    memo->has_carrier = true;
    memo->carried_id = s->surface_id;
    memo->carried_piece = s->piece;
    memo->carrier = carrier_at(frame->placement, s, 0.5);
    memo->carried_back = pl_affine_inverse(&memo->carrier.place).m;
  }
  return &memo->carrier;
}

/* --- what a ray hit --------------------------------------------------------------------------- */

static pl_affine place_of_mesh(const pl_shot_object *object, const pl_shot_piece *piece) {
  if (piece != NULL)
    return (pl_affine){piece->linear, piece->origin};
  pl_affine out = {object->rotation, object->position};
  for (int k = 0; k < 3; k++)
    out.m.row[k] = pl_vec3_scale(out.m.row[k], object->scale);
  /* mesh coordinates count from the file's origin */
  out.t = pl_vec3_sub(out.t, pl_mat3_mul_vec(out.m, object->object->offset));
  return out;
}

static pl_affine place_of(const pl_snapshot *shot, const pl_sight *s) {
  if (!pl_surface_is_mesh(s->surface_id)) {
    const pl_shot_body *body = pl_shot_body_of(shot, s->surface_id);
    return (pl_affine){body->rotation, body->center};
  }
  const pl_shot_object *object = pl_shot_object_of(shot, s->surface_id);
  return place_of_mesh(object, object->pieces != NULL ? &object->pieces[s->piece] : NULL);
}

/* Finds the transforms of the surface of a sight, unless they are those that are known. */
static void find_place(const pl_snapshot *shot, const pl_sight *s, pl_sight_memo *memo) {
  if (memo->has_place && memo->piece == s->piece &&
      pl_surface_same(memo->surface_id, s->surface_id))
    return;
  memo->has_place = true;
  memo->surface_id = s->surface_id;
  memo->piece = s->piece;
  memo->place = place_of(shot, s);
  memo->back = pl_affine_inverse(&memo->place);
}

pl_sight pl_sight_of(const pl_snapshot *shot, const pl_point *point, pl_sight_memo *memo) {
  pl_sight s = {.is_point = true,
                .surface_id = point->surface_id,
                .index = pl_surface_index(point->surface_id)};
  if (pl_surface_is_mesh(point->surface_id)) {
    const pl_shot_object *object = pl_shot_object_of(shot, point->surface_id);
    const pl_shot_piece *piece = pl_shot_piece_of(object, point->triangle);
    s.object = object->object;
    s.piece = piece != NULL ? (size_t)(piece - object->pieces) : 0;
    s.triangle = point->triangle + 1;
  } else {
    s.radii = pl_shot_body_of(shot, point->surface_id)->state->radii_m;
    s.cell_m = (double)pl_vec3f_norm(point->edge1);
  }
  find_place(shot, &s, memo);
  s.local = pl_affine_apply(&memo->back, point->position);
  /* Normals are covectors. */
  s.normal = pl_mat3_mul_vec_t(memo->place.m, pl_vec3f_to_double(point->facet));
  return s;
}

/* --- images ----------------------------------------------------------------------------------- */

bool pl_sight_is_there(const pl_sight_frame *frame, const pl_sight *s) {
  const bool *changed = frame->changed;
  if (!s->is_point)
    return true;
  if (s->object == NULL)
    return changed == NULL || !changed[s->index];
  if (s->object->body >= 0)
    return changed == NULL || !changed[s->object->body];
  return s->object->cut == NULL || frame->shot->objects[s->index].pieces[s->piece].present;
}

/* Iterations and largest change, in pixels, of the row at whose time a point is seen. */
enum { ROW_ITERATIONS = 40 };
static const double ROW_PX = 1e-7;

bool pl_sight_project(const pl_sight_frame *frame, const pl_sight *s, pl_sight_memo *memo,
                      pl_vec3 *point, double pixel[2]) {
  const pl_placement *placement = frame->placement;
  double row = 0.5 * (placement->camera.height - 1);
  for (int i = 0; i < ROW_ITERATIONS; i++) {
    pl_carrier of_row;
    const pl_carrier *c = &of_row;
    if (frame->rows)
      of_row = carrier_at(placement, s, pl_shutter_row_share(placement, row));
    else
      c = carry(frame, s, memo);
    *point = pl_mat3_mul_vec_t(c->camera, pl_affine_apply(&c->place, s->local));
    if (!pl_camera_project(&frame->shot->rays.camera, *point, pixel))
      return false;
    if (!frame->rows || fabs(pixel[1] - row) <= ROW_PX)
      return true;
    row = pixel[1];
  }
  return false;
}

bool pl_pixel_in_image(const pl_camera *camera, const double pixel[2]) {
  return pixel[0] >= -0.5 && pixel[0] < camera->width - 0.5 && pixel[1] >= -0.5 &&
         pixel[1] < camera->height - 0.5;
}

/* --- what hides them -------------------------------------------------------------------------- */

/* Grounds of two frames have other cells: their heights differ by a part of a cell, which is as
 * much more along a grazing ray. */
static const double PART_OF_CELL = 0.5, GRAZING_GROUND = 0.1;
/* Rounding of hits on meshes, over the object's radius, and along the ray. */
static const double ROUNDING = 0x1p-18, GRAZING_MESH = 0.01;

static bool is_own(const pl_sight *s, pl_surface_id met) {
  if (s->object != NULL || pl_surface_is_mesh(met))
    return pl_surface_same(met, s->surface_id);
  return pl_surface_index(met) == s->index; /* ground and its rocks */
}

/* How much nearer a hit may be than the point and yet be the point's own surface. */
static double slack_m(const pl_sight_frame *frame, const pl_sight *s, const pl_hit *hit,
                      pl_vec3 ray, double cosine) {
  const pl_geometry_kind *kind = pl_geometry_of(hit->surface_id);
  const bool own = is_own(s, hit->surface_id);
  const double deep_m = own ? s->deep_m : 0.0;
  if (own && s->object == NULL && !pl_surface_is_ellipsoid(hit->surface_id)) {
    const pl_beam beam = {.direction = ray};
    pl_vertex there;
    pl_vertex_locate(frame->shot, &beam, hit, true, &there);
    const double cell_m = fmax((double)pl_vec3f_norm(there.edge1), s->cell_m);
    return deep_m + PART_OF_CELL * cell_m / fmax(cosine, GRAZING_GROUND);
  }
  const double radius_m = kind->bounds(frame->shot, hit->surface_id).radius_m;
  return deep_m + ROUNDING * radius_m / fmax(cosine, GRAZING_MESH);
}

/* Cosine between the way to the camera and the normal; without one above 0: on a body that to the
 * radius, else 1. */
static double cosine_of(const pl_sight *s, const pl_sight_memo *memo, pl_vec3 ray) {
  if (!(pl_vec3_dot(s->normal, s->normal) > 0.0))
    return s->object != NULL
               ? 1.0
               : fmax(-pl_vec3_dot(pl_vec3_unit(pl_mat3_mul_vec(memo->carrier.place.m, s->local)),
                                   ray),
                      1e-9);
  return -pl_vec3_dot(pl_vec3_unit(pl_mat3_mul_vec_t(memo->carried_back, s->normal)), ray);
}

/* Whether a hit is where the point is, whatever its distance. Ellipsoids are convex. */
static bool is_there_itself(const pl_sight *s, const pl_hit *hit) {
  return pl_surface_same(hit->surface_id, s->surface_id) &&
         (pl_surface_is_ellipsoid(hit->surface_id) ||
          (s->object != NULL && s->triangle == hit->triangle + 1));
}

bool pl_sight_look(const pl_sight_frame *frame, const pl_sight *s, pl_sight_memo *memo,
                   pl_sight_query *out) {
  const pl_carrier *c = carry(frame, s, memo);
  const pl_vec3 p = pl_affine_apply(&c->place, s->local);
  out->distance_m = pl_vec3_norm(p);
  out->ray = (pl_ray){.t_max = INFINITY,
                      .direction = pl_vec3_scale(p, 1.0 / out->distance_m),
                      .skip_body = PL_NO_BODY,
                      .from_surface = PL_NO_SURFACE};
  out->cosine = s->is_point ? cosine_of(s, memo, out->ray.direction) : 1.0;
  return out->cosine > 0.0;
}

pl_surface_id pl_sight_hider(const pl_sight_frame *frame, const pl_sight *s,
                             const pl_sight_query *query, const pl_hit *hit) {
  if (pl_surface_is_none(hit->surface_id) || !s->is_point)
    return hit->surface_id;
  if (is_there_itself(s, hit))
    return PL_NO_SURFACE;
  const double slack = slack_m(frame, s, hit, query->ray.direction, query->cosine);
  return hit->t < query->distance_m - slack ? hit->surface_id : PL_NO_SURFACE;
}

pl_surface_id pl_sight_hidden_by(const pl_sight_frame *frame, const pl_sight *s,
                                 pl_sight_memo *memo) {
  pl_sight_query query;
  pl_hit hit;
  if (!pl_sight_look(frame, s, memo, &query))
    return s->surface_id;
  pl_tracer_closest(frame->tracer, &query.ray, &hit, 1, false, true);
  return pl_sight_hider(frame, s, &query, &hit);
}
