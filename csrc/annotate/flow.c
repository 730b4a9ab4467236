#include "annotate/flow.h"

#include <string.h>

#include "annotate/channel.h"
#include "math/affine.h"
#include "render/geometry.h"
#include "scene/shutter.h"

static const struct {
  const char *name;
  pl_flow_to to;
} images[PL_FLOW_IMAGES] = {
    [PL_FLOW_FORWARD] = {"flow", PL_FLOW_NEXT},
    [PL_FLOW_BACKWARD] = {"flow_backward", PL_FLOW_PREVIOUS},
    [PL_FLOW_OCCLUDED_FORWARD] = {"flow_occlusion", PL_FLOW_NEXT},
    [PL_FLOW_OCCLUDED_BACKWARD] = {"flow_occlusion_backward", PL_FLOW_PREVIOUS},
    [PL_FLOW_SCENE] = {"scene_flow", PL_FLOW_NEXT},
};

bool pl_flow_init(void *const *channels, pl_flow *out) {
  bool any = false;
  *out = (pl_flow){.frames = {NULL}};
  for (size_t i = 0; i < pl_channel_count; i++)
    for (size_t k = 0; k < PL_FLOW_IMAGES && channels[i] != NULL; k++)
      if (strcmp(pl_channels[i].name, images[k].name) == 0) {
        out->images[k] = channels[i];
        out->wanted[images[k].to] = any = true;
      }
  return any;
}

/* --- where a point is in the other frame ------------------------------------------------------ */

/* What the pixel sees: a point in coordinates that move with its surface, or a direction. */
typedef struct sight {
  const pl_vertex *vertex; /* NULL: nothing is hit */
  pl_vec3 local;           /* mesh units, body axes, or for a direction root axes */
  pl_vec3 normal;          /* the same for the geometric normal on the viewer's side; any length */
  const pl_object *object; /* NULL: a body, or nothing */
  size_t index;            /* of the object or body */
  size_t piece;            /* of an articulated object */
  pl_vec3 radii;           /* of a body, here */
} sight;

/* From the coordinates of a sight to camera-relative ones, root axes. */
typedef struct carrier {
  pl_affine place;
  pl_mat3 camera; /* camera axes to root axes */
} carrier;

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
static pl_affine object_at(const pl_placement *placement, const sight *s, double u,
                           pl_vec3 camera) {
  const pl_object_state state = pl_placement_object(placement, s->object, s->index);
  const double scale = state.scale * s->object->model->unit;
  pl_affine out = rigid(pl_motion_at(&state.motion, u), camera);
  pl_affine mesh = PL_AFFINE_IDENTITY;
  if (s->object->cut != NULL && s->piece > 0) {
    const size_t movers = pl_object_mover_count(s->object);
    const pl_affine motion = mover_at(&state, movers, s->piece - 1, u);
    mesh = pl_model_mesh_motion(s->object->model, &motion);
  } else if (s->object->cut != NULL) {
    mesh = pl_model_mesh_motion(s->object->model, &mesh);
  }
  mesh.t = pl_vec3_sub(mesh.t, s->object->offset);
  for (int k = 0; k < 3; k++)
    mesh.m.row[k] = pl_vec3_scale(mesh.m.row[k], scale);
  mesh.t = pl_vec3_scale(mesh.t, scale);
  return pl_affine_compose(&out, &mesh);
}

/* A body that grows carries its surface with it. */
static pl_affine body_at(const pl_placement *placement, const sight *s, double u, pl_vec3 camera) {
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

static carrier carrier_at(const pl_placement *placement, const sight *s, double u) {
  const pl_pose camera = pl_motion_at(&placement->camera.motion, u);
  carrier out = {PL_AFFINE_IDENTITY, pl_mat3_from_quat(camera.q)};
  if (s->vertex != NULL)
    out.place = s->object != NULL ? object_at(placement, s, u, camera.t)
                                  : body_at(placement, s, u, camera.t);
  return out;
}

/* Sets the local coordinates by the inverse of the transform in the frame that is seen. */
static void localise(const pl_affine *here, sight *s) {
  const pl_affine back = pl_affine_inverse(here);
  s->local = pl_affine_apply(&back, s->vertex->position);
  /* Normals are covectors. */
  s->normal =
      pl_mat3_mul_vec(pl_mat3_transpose(here->m), pl_vec3f_to_double(s->vertex->surface.ng));
}

static pl_affine scaled_rotation(pl_mat3 rotation, double scale, pl_vec3 t) {
  for (int k = 0; k < 3; k++)
    rotation.row[k] = pl_vec3_scale(rotation.row[k], scale);
  return (pl_affine){rotation, t};
}

static sight sight_of(const pl_snapshot *shot, const pl_vertex *vertex) {
  sight s = {.vertex = vertex};
  if (pl_surface_is_mesh(vertex->surface_id)) {
    const pl_shot_object *object = pl_shot_object_of(shot, vertex->surface_id);
    const pl_shot_piece *piece = pl_shot_piece_of(object, vertex->triangle);
    s.object = object->object;
    s.index = pl_surface_index(vertex->surface_id);
    s.piece = piece != NULL ? (size_t)(piece - object->pieces) : 0;
    pl_affine here = scaled_rotation(object->rotation, object->scale, object->position);
    if (piece != NULL)
      here = (pl_affine){piece->linear, piece->origin};
    else /* mesh coordinates count from the file's origin */
      here.t = pl_vec3_sub(here.t, pl_mat3_mul_vec(here.m, object->object->offset));
    localise(&here, &s);
  } else {
    const pl_shot_body *body = pl_shot_body_of(shot, vertex->surface_id);
    const pl_affine here = {body->rotation, body->center};
    s.index = pl_surface_index(vertex->surface_id);
    s.radii = body->state->radii_m;
    localise(&here, &s);
  }
  return s;
}

/* Whether the surface is there in the other frame. */
static bool is_there(const pl_flow_frame *to, const sight *s) {
  const bool *changed = to->frame->changed;
  if (s->vertex == NULL)
    return true;
  if (s->object == NULL)
    return changed == NULL || !changed[s->index];
  if (s->object->body >= 0)
    return changed == NULL || !changed[s->object->body];
  return s->object->cut == NULL || to->shot.objects[s->index].pieces[s->piece].present;
}

static pl_vec3 in_camera(const carrier *c, const sight *s) {
  const pl_vec3 p = s->vertex != NULL ? pl_affine_apply(&c->place, s->local) : s->local;
  return pl_mat3_mul_vec_t(c->camera, p);
}

/* Iterations and largest change, in pixels, of the row at whose time a point is seen. */
enum { ROW_ITERATIONS = 40 };
static const double ROW_PX = 1e-7;

/* Projects what is seen to the other frame; with a rolling shutter at the time of the row that it
 * is then seen in. Returns false if it has no image. */
static bool project(const pl_flow_frame *to, const sight *s, pl_vec3 *point, double pixel[2]) {
  const pl_placement *placement = &to->frame->placement;
  double row = 0.5 * (placement->camera.height - 1);
  for (int i = 0; i < ROW_ITERATIONS; i++) {
    const double u = to->rows ? pl_shutter_row_share(placement, row) : 0.5;
    const carrier c = carrier_at(placement, s, u);
    *point = in_camera(&c, s);
    if (!pl_camera_project(&to->shot.camera, *point, pixel))
      return false;
    if (!to->rows || fabs(pixel[1] - row) <= ROW_PX)
      return true;
    row = pixel[1];
  }
  return false;
}

/* --- what hides it ---------------------------------------------------------------------------- */

static bool in_image(const pl_camera *camera, const double pixel[2]) {
  return pixel[0] >= -0.5 && pixel[0] < camera->width - 0.5 && pixel[1] >= -0.5 &&
         pixel[1] < camera->height - 0.5;
}

/* Grounds of two frames have other cells: their heights differ by a part of a cell, which is as
 * much more along a grazing ray. */
static const double PART_OF_CELL = 0.5, GRAZING_GROUND = 0.1;
/* Rounding of hits on meshes, over the object's radius, and along the ray. */
static const double ROUNDING = 0x1p-18, GRAZING_MESH = 0.01;

/* How much nearer a hit may be than the point and yet be the point's own surface. */
static double slack_m(const pl_flow_frame *to, const sight *s, const pl_hit *hit, pl_vec3 ray,
                      double cosine) {
  const pl_surface_kind kind = pl_surface_kind_of(hit->surface_id);
  const bool own_body = s->object == NULL && !pl_surface_is_mesh(hit->surface_id) &&
                        pl_surface_index(hit->surface_id) == s->index;
  if (own_body && kind != PL_SURFACE_ELLIPSOID) {
    const pl_beam beam = {.direction = ray};
    pl_vertex there;
    pl_vertex_locate(&to->shot, &beam, hit, true, &there);
    const float cell = pl_maxf(pl_vec3f_norm(there.edge1), pl_vec3f_norm(s->vertex->edge1));
    return PART_OF_CELL * (double)cell / fmax(cosine, GRAZING_GROUND);
  }
  const pl_geometry_bounds bounds =
      pl_geometry_of(hit->surface_id)->bounds(&to->shot, hit->surface_id);
  return ROUNDING * bounds.radius_m / fmax(cosine, GRAZING_MESH);
}

/* Whether something hides what is seen from the other camera, or it turns its other side there. In
 * the middle of the exposure. */
static bool is_hidden(const pl_flow_frame *to, const sight *s) {
  const carrier c = carrier_at(&to->frame->placement, s, 0.5);
  const pl_vec3 p = s->vertex != NULL ? pl_affine_apply(&c.place, s->local) : s->local;
  const pl_vec3 ray = pl_vec3_unit(p);
  const double distance_m = s->vertex != NULL ? pl_vec3_norm(p) : INFINITY;
  double cosine = 1.0;
  if (s->vertex != NULL) {
    const pl_affine back = pl_affine_inverse(&c.place);
    const pl_vec3 n = pl_vec3_unit(pl_mat3_mul_vec(pl_mat3_transpose(back.m), s->normal));
    cosine = -pl_vec3_dot(n, ray);
    if (!(cosine > 0.0))
      return true;
  }
  const pl_ray seen = {
      .t_max = INFINITY, .direction = ray, .skip_body = PL_NO_BODY, .from_surface = PL_NO_SURFACE};
  pl_hit hit;
  pl_tracer_closest(to->tracer, &seen, &hit, 1, false, true);
  if (pl_surface_is_none(hit.surface_id))
    return false;
  if (s->vertex == NULL)
    return true;
  const bool same = pl_surface_same(hit.surface_id, s->vertex->surface_id);
  const bool triangle = s->object != NULL && hit.triangle == s->vertex->triangle;
  if (same && (triangle || pl_surface_is_ellipsoid(hit.surface_id)))
    return false; /* ellipsoids are convex */
  return hit.t < distance_m - slack_m(to, s, &hit, ray, cosine);
}

/* --- images ----------------------------------------------------------------------------------- */

/* Writes a pixel of the images that lead to one frame; `at` is its row-major index. */
static void write_pixel(const pl_flow *flow, pl_flow_to which, const sight *s, pl_vec3 here,
                        const double from[2], size_t at) {
  const pl_flow_frame *to = flow->frames[which];
  float *out = flow->images[which == PL_FLOW_NEXT ? PL_FLOW_FORWARD : PL_FLOW_BACKWARD];
  uint8_t *hidden =
      flow->images[which == PL_FLOW_NEXT ? PL_FLOW_OCCLUDED_FORWARD : PL_FLOW_OCCLUDED_BACKWARD];
  float *moved = which == PL_FLOW_NEXT ? flow->images[PL_FLOW_SCENE] : NULL;
  double pixel[2] = {NAN, NAN};
  pl_vec3 there = {NAN, NAN, NAN};
  const bool known = to != NULL && s != NULL && is_there(to, s) && project(to, s, &there, pixel);
  for (size_t k = 0; out != NULL && k < 2; k++)
    out[2 * at + k] = known ? (float)(pixel[k] - from[k]) : NAN;
  if (hidden != NULL)
    hidden[at] = !known || !in_image(&to->shot.camera, pixel) || is_hidden(to, s);
  if (moved == NULL)
    return;
  const bool point = s != NULL && s->vertex != NULL && to != NULL && is_there(to, s);
  moved[3 * at] = point ? (float)(there.x - here.x) : NAN;
  moved[3 * at + 1] = point ? (float)(there.y - here.y) : NAN;
  moved[3 * at + 2] = point ? (float)(there.z - here.z) : NAN;
}

void pl_flow_write(const pl_flow *flow, const pl_snapshot *shot, const pl_vertex *points,
                   size_t stride, const int tile[4]) {
  for (int y = 0; y < tile[3]; y++)
    for (int x = 0; x < tile[2]; x++) {
      const double from[2] = {tile[0] + x, tile[1] + y};
      const size_t at = (size_t)(tile[1] + y) * (size_t)shot->camera.width + (size_t)(tile[0] + x);
      const pl_vertex *vertex = points != NULL ? &points[(size_t)y * stride + (size_t)x] : NULL;
      sight s = {.vertex = NULL};
      pl_vec3 here = {0.0, 0.0, 0.0};
      if (vertex != NULL && !pl_surface_is_none(vertex->surface_id)) {
        s = sight_of(shot, vertex);
        here = pl_mat3_mul_vec_t(shot->camera_to_root, vertex->position);
      } else {
        s.local = pl_snapshot_ray(shot, from[0], from[1]);
      }
      const bool any = s.vertex != NULL || pl_vec3_dot(s.local, s.local) > 0.0;
      for (int to = 0; to < PL_FLOW_FRAMES; to++)
        if (flow->wanted[to])
          write_pixel(flow, (pl_flow_to)to, any ? &s : NULL, here, from, at);
    }
}
