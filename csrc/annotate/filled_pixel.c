#include "annotate/filled_pixel.h"

#include <math.h>

#include "scene/graph_point.h"
#include "scene/shot_frame.h"

/* Triangles of a sheet that are looked at in a pixel. */
enum { SHEET_MOST = 24 };
/* As far as rays leave the centre of a pixel: pl_image_sample_offset reaches 0.542 with three
 * samples. */
static const double REACH_PX = 0.55;
/* As in coverage_mask.c: hits are off by less than these times the lengths that are summed in the
 * model's frame, and the distance to the model. */
static const double ROUNDING = 1e-6, ROUNDING_AWAY = 4e-15;
/* Objects that touch within rounding may hide each other (tracer.c, ONE_PLACE: 2e-6 of their
 * sizes).
 */
static const double TOUCHING = 1e-5;
/* Least sine of the angle between a face and the ray through its corner, for its side to be
 * certain.
 */
static const double GRAZING = 1e-12;

/* Rays about a unit axis, root axes. */
typedef struct cone {
  pl_vec3 axis;
  double sine, cosine; /* of its half angle */
} cone;

/* A triangle of a sheet, camera-relative, m. */
typedef struct face {
  pl_vec3 corners[3];
  double side; /* 1: its corners are clockwise as seen from the camera; -1: counter-clockwise */
} face;

typedef struct sheet {
  const pl_shot_object *object;
  const pl_shot_piece *piece;
  const pl_adjacency *adjacency;
  double rounding_m, far_m;
  size_t count;
  uint32_t triangles[SHEET_MOST];
  bool turned[SHEET_MOST]; /* wound against the first one */
} sheet;

/* The chord between unit vectors is no less than the sine of their angle; of a rectangle's rays
 * through a pinhole those of its corners are farthest from any ray. */
static bool find_cone(const pl_snapshot *shot, const double rect[4], cone *out) {
  double chord = 0.0;
  out->axis = pl_snapshot_ray(shot, 0.5 * (rect[0] + rect[2]), 0.5 * (rect[1] + rect[3]));
  for (int k = 0; k < 4; k++) {
    const pl_vec3 ray = pl_snapshot_ray(shot, rect[k & 1 ? 2 : 0], rect[k & 2 ? 3 : 1]);
    chord = fmax(chord, pl_vec3_norm(pl_vec3_sub(ray, out->axis)));
  }
  out->sine = chord * (1.0 + 1e-9);
  out->cosine = sqrt(fmax(0.0, 1.0 - out->sine * out->sine));
  return out->sine < 1.0;
}

/* Whether a sphere reaches into a cone nearer than a distance. */
static bool is_within(const cone *cone, const pl_fill_sphere *sphere, double far_m) {
  const double away = pl_vec3_norm(sphere->center), radius = sphere->radius_m;
  if (away - radius > far_m)
    return false;
  const double along = pl_vec3_dot(sphere->center, cone->axis);
  const double across = pl_vec3_norm(pl_vec3_cross(sphere->center, cone->axis));
  /* Distance from the centre to the nearest line of the cone, or a bound of it. */
  return across * cone->cosine - along * cone->sine <= radius + ROUNDING_AWAY * away;
}

static bool add_near(pl_fill *fill, const cone *cone, pl_vec3 center, double radius_m,
                     size_t object) {
  const pl_fill_sphere sphere = {center, radius_m * (1.0 + TOUCHING), object};
  if (!is_within(cone, &sphere, INFINITY))
    return true;
  if (fill->count == PL_FILL_NEAR_MOST)
    return false;
  fill->near[fill->count++] = sphere;
  return true;
}

void pl_fill_begin(const pl_snapshot *shot, const pl_adjacency *const *adjacencies, pl_tile tile,
                   pl_fill *out) {
  const double rect[4] = {tile.x0 - REACH_PX, tile.y0 - REACH_PX,
                          tile.x0 + tile.width - 1 + REACH_PX,
                          tile.y0 + tile.height - 1 + REACH_PX};
  cone cone;
  out->shot = shot;
  out->adjacencies = adjacencies;
  out->count = 0;
  out->possible = adjacencies != NULL && shot->rays.camera.lens.model == NULL &&
                  shot->rays.kind->projects && find_cone(shot, rect, &cone);
  for (size_t i = 0; out->possible && i < shot->object_count; i++)
    if (shot->objects[i].kept)
      out->possible = add_near(out, &cone, shot->objects[i].center, shot->objects[i].radius_m, i);
  for (size_t i = 0; out->possible && i < shot->body_count; i++)
    if (shot->bodies[i].shape == NULL)
      out->possible =
          add_near(out, &cone, shot->bodies[i].center, shot->bodies[i].outer_m, SIZE_MAX);
}

/* Bound of the position error of hits, m. */
static double rounding_of(const pl_shot_object *object, const pl_shot_piece *piece) {
  const float *low = object->object->model->bounds_min, *high = object->object->model->bounds_max;
  double scale = object->scale, length = 0.0;
  if (piece != NULL) {
    const pl_mat3 columns = pl_mat3_transpose(piece->linear);
    scale = 0.0;
    for (int k = 0; k < 3; k++)
      scale = fmax(scale, pl_vec3_norm(columns.row[k]));
  }
  for (int k = 0; k < 3; k++)
    length += fmax(fabs((double)low[k]), fabs((double)high[k]));
  return ROUNDING * (scale * length + object->radius_m) +
         ROUNDING_AWAY * pl_vec3_norm(object->center);
}

/* Places a triangle; false if its side is not certain, or rays may pass it. */
static bool place(const sheet *s, uint32_t triangle, face *out) {
  const pl_model *model = s->object->object->model;
  const uint32_t *corner = model->indices + 3 * (size_t)triangle;
  if (pl_shot_piece_of(s->object, triangle) != s->piece ||
      pl_material_of(model, triangle)->alpha_mode != PL_ALPHA_OPAQUE)
    return false;
  for (int k = 0; k < 3; k++)
    out->corners[k] = pl_shot_corner(s->object, s->piece, model->positions + 3 * (size_t)corner[k]);
  const pl_vec3 a = pl_vec3_sub(out->corners[1], out->corners[0]);
  const pl_vec3 b = pl_vec3_sub(out->corners[2], out->corners[0]);
  const double volume = pl_vec3_dot(pl_vec3_cross(a, b), out->corners[0]);
  const double least = GRAZING * pl_vec3_norm(a) * pl_vec3_norm(b) * pl_vec3_norm(out->corners[0]);
  out->side = volume > 0.0 ? 1.0 : -1.0;
  return fabs(volume) > least;
}

/* Whether rays meet a face: all do from the front, and the back where it exists. */
static bool exists(const sheet *s, uint32_t triangle, double side) {
  const bool behind = (s->piece != NULL && s->piece->side < 0.0f ? -side : side) > 0.0;
  if (!behind)
    return true;
  if (s->piece == NULL)
    return pl_back_is_there(s->object->object->model, triangle);
  const pl_cut *cut = s->object->object->cut;
  return pl_back_is_there(s->piece->model,
                          triangle - (uint32_t)cut->first[pl_cut_piece(cut, triangle)]);
}

/* Whether an edge of a face may meet the cone. */
static bool meets(const sheet *s, const cone *cone, const face *face, int k) {
  const pl_vec3 from = face->corners[k], to = face->corners[(k + 1) % 3];
  const pl_vec3 along = pl_vec3_sub(to, from), plane = pl_vec3_cross(from, along);
  const double room = s->rounding_m * pl_vec3_norm(along);
  if (fabs(pl_vec3_dot(plane, cone->axis)) > pl_vec3_norm(plane) * cone->sine + room)
    return false;
  /* Planes through the ends, across that of the edge. */
  const pl_vec3 first = pl_vec3_cross(plane, from), last = pl_vec3_cross(to, plane);
  const double reach = pl_vec3_norm(plane) * cone->sine;
  return pl_vec3_dot(first, cone->axis) > -(reach + room) * pl_vec3_norm(from) &&
         pl_vec3_dot(last, cone->axis) > -(reach + room) * pl_vec3_norm(to);
}

static bool has(const sheet *s, uint32_t triangle) {
  for (size_t i = 0; i < s->count; i++)
    if (s->triangles[i] == triangle)
      return true;
  return false;
}

/* Whether two half-edges lead from the same position, so that one triangle is wound against the
 * other. */
static bool is_same_way(const pl_model *model, uint32_t a, uint32_t b) {
  const float *p = model->positions + 3 * (size_t)model->indices[a];
  const float *q = model->positions + 3 * (size_t)model->indices[b];
  return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

/* Adds the neighbour across an edge that meets the cone; false if the sheet ends or folds there. */
static bool add_across(sheet *s, size_t i, uint32_t half) {
  const uint32_t across = s->adjacency->across[half];
  if (across >= PL_NO_NEIGHBOUR)
    return false;
  if (has(s, across / 3))
    return true;
  if (s->count == SHEET_MOST)
    return false;
  s->turned[s->count] = s->turned[i] != is_same_way(s->object->object->model, half, across);
  s->triangles[s->count++] = across / 3;
  return true;
}

/* Spreads the sheet from its first triangle over all edges that meet the cone. */
static bool spread(sheet *s, const cone *cone) {
  double side = 0.0;
  for (size_t i = 0; i < s->count; i++) {
    face face;
    if (!place(s, s->triangles[i], &face) || !exists(s, s->triangles[i], face.side))
      return false;
    const double own = s->turned[i] ? -face.side : face.side;
    side = i == 0 ? own : side;
    if (own != side)
      return false;
    for (int k = 0; k < 3; k++) {
      s->far_m = fmax(s->far_m, pl_vec3_norm(face.corners[k]));
      if (meets(s, cone, &face, k) && !add_across(s, i, 3 * s->triangles[i] + (uint32_t)k))
        return false;
    }
  }
  return true;
}

bool pl_fill_has(const pl_fill *fill, pl_surface_id id, uint32_t triangle, int x, int y) {
  if (!fill->possible || !pl_surface_is_mesh(id))
    return false;
  const size_t index = pl_surface_index(id);
  const pl_shot_object *object = &fill->shot->objects[index];
  const pl_adjacency *adjacency = fill->adjacencies[index];
  const double rect[4] = {x - REACH_PX, y - REACH_PX, x + REACH_PX, y + REACH_PX};
  cone cone;
  if (adjacency == NULL || adjacency->model != object->object->model ||
      pl_object_cuts(object->object) || !find_cone(fill->shot, rect, &cone))
    return false;
  sheet s = {.object = object,
             .piece = pl_shot_piece_of(object, triangle),
             .adjacency = adjacency,
             .count = 1,
             .triangles = {triangle}};
  s.rounding_m = rounding_of(object, s.piece);
  if (!spread(&s, &cone))
    return false;
  const double far_m = s.far_m + TOUCHING * object->radius_m;
  for (size_t i = 0; i < fill->count; i++)
    if (fill->near[i].object != index && is_within(&cone, &fill->near[i], far_m))
      return false;
  return true;
}
